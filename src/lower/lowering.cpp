// The top level: definitions first, then knobs, then the statements in order; at the end the
// outputs.
#include <algorithm>

#include "lower/lowering.h"

#include "lang/parser.h"
#include "lower/constant.h"
#include "lower/library.h"

namespace pse::lower {

using namespace lang;

Lowering::Lowering(SourceMap& sources, const LowerHost& host, const LowerOptions& options,
                   Diagnostics& diagnostics)
    : sources_(sources), host_(host), options_(options), diagnostics_(&diagnostics) {
  module_.functions.reserve(BuiltinEmitter::room_for_builtins + 1);
  module_.functions.emplace_back();
  module_.functions.front().name = "main";
}

// ---- Reports and limits -------------------------------------------------------------------------

// A function of the library is right: what it cannot do is the fault of what it was called with,
// and the call is the place. In a function of another module, the program's own call is named
// beside it.
Blame Lowering::blame(const char* code, const Span& span, std::string message,
                      std::string suggestion) const {
  const auto in_library = [&](const Span& place) { return library_texts_.contains(place.file); };
  const Call* call = span.valid() && span.file != main_.file ? call_ : nullptr;
  if (call && in_library(span)) {
    // What the library has said it needs tells more than what comes of it.
    std::string unmet = call->unmet;
    while (call && in_library(call->call_span)) {
      call = call->caller;
      if (call && unmet.empty()) unmet = call->unmet;
    }
    if (!unmet.empty()) message = unmet, suggestion.clear();
    if (!call || !call->call_span.valid() || !call->definition)
      return {span, std::move(message), std::move(suggestion)};
    std::string head = "`" + call->definition->name + "` cannot be called here: ";
    const bool by_shape =
        code != std::string_view("unknown-name") && code != std::string_view("too-large");
    if (by_shape && call->arguments && !call->arguments->empty()) {
      head = "`" + call->definition->name + "` cannot be called with ";
      for (std::size_t i = 0; i < call->arguments->size(); ++i)
        head += (i == 0 ? "" : i + 1 < call->arguments->size() ? ", " : " and ") +
                describe((*call->arguments)[i].value);
      head += ": ";
    }
    suggestion += (suggestion.empty() ? "see " : "; see ") + sources_.describe(span);
    return {call->call_span, head + message, std::move(suggestion)};
  }
  while (call && call->call_span.file != main_.file) call = call->caller;
  if (call && call->call_span.valid())
    suggestion += (suggestion.empty() ? "called from " : "; called from ") +
                  sources_.describe(call->call_span);
  return {span, std::move(message), std::move(suggestion)};
}

void Lowering::error(const char* code, const Span& span, std::string message,
                     std::string suggestion) {
  Blame found = blame(code, span, std::move(message), std::move(suggestion));
  // One wrong call makes one error, however often the library stumbles over it.
  if (!(found.span == span))
    for (const Diagnostic& earlier : diagnostics_->all())
      if (earlier.severity == Severity::error && earlier.span == found.span) return;
  diagnostics_->error(code, found.span, std::move(found.message), std::move(found.suggestion));
}

Span Lowering::program_place(const Span& span) const {
  const Call* call = span.valid() && span.file != main_.file ? call_ : nullptr;
  while (call && call->call_span.file != main_.file) call = call->caller;
  return call && call->call_span.valid() ? call->call_span : span;
}

void Lowering::warning(const char* code, const Span& span, std::string message,
                       std::string suggestion) {
  diagnostics_->warning(code, span, std::move(message), std::move(suggestion));
}

ir::Value Lowering::emit(ir::Op op, std::initializer_list<ir::Value> operands, std::int32_t imm,
                         std::int32_t component) {
  return builder_->emit(op, operands, imm, component);
}

void Lowering::check_size() {
  if (builder_->emitted() <= options_.max_instructions) return;
  error(
      "too-large", builder_->span(),
      "the program grows beyond " + std::to_string(options_.max_instructions) + " operations here",
      "functions are copied into their callers: call large ones from a loop instead of many "
      "places");
  throw TooLarge{};
}

// ---- Modules ------------------------------------------------------------------------------------

void Lowering::read_definitions(const Program& program, ModuleScope& scope) {
  const bool imported = &scope != &main_;
  for (const StmtPtr& statement : program.body) {
    if (!statement) continue;
    if (const auto* function = std::get_if<FunctionStmt>(&statement->node)) {
      if (!scope.functions.emplace(function->name, function).second)
        error("function-twice", function->name_span,
              "function `" + function->name + "` is defined twice");
      std::set<std::string> parameters;
      for (const Parameter& parameter : function->parameters)
        if (!parameters.insert(parameter.name).second)
          error("parameter-twice", parameter.span,
                "`" + function->name + "` has two parameters named `" + parameter.name + "`");
    } else if (const auto* import = std::get_if<ImportStmt>(&statement->node)) {
      ModuleScope* module = load_module(import->module, import->module_span);
      if (!module) continue;
      if (import->alias.empty())
        scope.open_imports.push_back(module);
      else
        scope.named_imports[import->alias] = module;
    } else if (const auto* assign = std::get_if<AssignStmt>(&statement->node); assign && imported) {
      if (const auto* name = std::get_if<NameExpr>(&assign->target->node);
          name && assign->op == AssignOp::set)
        scope.constants[name->name] = assign->value.get();
    }
  }
}

ModuleScope* Lowering::adopt(FileId file, const std::string& name) {
  Diagnostics parsed;
  auto scope = std::make_unique<ModuleScope>();
  scope->file = file;
  scope->name = name;
  scope->program = std::make_unique<Program>(parse(sources_, file, parsed));
  for (const Diagnostic& diagnostic : parsed.all()) diagnostics_->add(diagnostic);
  ModuleScope* result = scope.get();
  modules_[name] = std::move(scope);
  read_definitions(*result->program, *result);
  return result;
}

ModuleScope* Lowering::adopt_library(const LibraryFile& file, const std::string& name) {
  const FileId text =
      sources_.add("library/" + std::string(file.name) + ".pse", std::string(file.text));
  library_texts_.insert(text);
  return adopt(text, name);
}

ModuleScope* Lowering::load_module(const std::string& name, const Span& span) {
  if (const auto found = modules_.find(name); found != modules_.end()) return found->second.get();
  // A file of the user's comes first, so that a new file of the library changes no program.
  const auto library = std::ranges::find(library_files(), name, &LibraryFile::name);
  const bool in_library = library != library_files().end();
  if (host_.find_module)
    if (const auto file = host_.find_module(sources_, name)) {
      if (in_library)
        warning(
            "hides-library", span,
            "this is " + sources_.file(*file).name + ", not the library's module `" + name + "`",
            "rename the file to import the library's; its functions are found without an import");
      if (sources_.file(*file).text == sources_.file(span.file).text)
        warning("imports-itself", span, "`" + name + "` is this file itself",
                "what it defines is known without an import");
      imported_.push_back(adopt(*file, name));
      return imported_.back();
    }
  if (in_library) return adopt_library(*library, name);
  std::vector<std::string> names;
  for (const LibraryFile& file : library_files()) names.emplace_back(file.name);
  const std::string near = did_you_mean(name, names);
  error("unknown-module", span, "there is no module `" + name + "`",
        !near.empty() ? near
                      : "a module is a file `" + name + ".pse` beside the program or on PSE_PATH");
  modules_[name] = nullptr;
  return nullptr;
}

ModuleScope* Lowering::library_module_of(const std::string& name) {
  const std::span<const LibraryFile> files = library_files();
  if (library_index_.empty())
    for (std::size_t i = 0; i < files.size(); ++i)
      for (const std::string& function : functions_defined_in(files[i].text))
        library_index_.emplace(function, static_cast<int>(i));
  const auto found = library_index_.find(name);
  if (found == library_index_.end()) return nullptr;
  const LibraryFile& file = files[static_cast<std::size_t>(found->second)];
  const std::string key = "library/" + std::string(file.name);
  if (const auto loaded = modules_.find(key); loaded != modules_.end()) return loaded->second.get();
  return adopt_library(file, key);
}

// ---- The stream and the knobs -------------------------------------------------------------------

const StreamName* Lowering::stream_name(const std::string& name) const {
  for (const StreamName& candidate : options_.stream)
    if (candidate.name == name) return &candidate;
  return nullptr;
}

std::int32_t Lowering::input_index(const std::string& name, ir::Rate rate, ir::InputSlopes slopes) {
  const auto [found, fresh] =
      inputs_.emplace(name, static_cast<std::int32_t>(module_.inputs.size()));
  if (fresh) module_.inputs.push_back({name, rate, slopes});
  return found->second;
}

Typed Lowering::read_stream(const StreamName& name) {
  if (frame_blocks_ > 0 && name.rate == ir::Rate::sample)
    warning(
        "varies-in-frame", builder_->span(),
        "`" + name.name + "` differs from sample to sample, so this is not computed once per frame",
        "move it out of `if begin_frame`");
  bool read = false;
  for (const std::string& known_name : reads_) read = read || known_name == name.name;
  if (!read) reads_.push_back(name.name);
  if (name.components == 1)
    return number(emit(ir::Op::input, {}, input_index(name.name, name.rate, name.slopes)));
  std::vector<ir::Value> parts;
  for (int c = 0; c < name.components; ++c)
    parts.push_back(emit(ir::Op::input, {},
                         input_index(name.name + "." + std::to_string(c), name.rate, name.slopes)));
  return vector(std::move(parts));
}

Typed Lowering::read_knob(std::size_t index) {
  const Knob& knob = knobs_[index];
  if (knob.is_text()) return {.kind = Kind::text, .parts = {}, .text = knob.text, .function = {}};
  std::vector<ir::Value> parts;
  for (std::size_t c = 0; c < knob.value.size(); ++c) {
    const std::string input =
        knob.value.size() == 1 ? knob.name : knob.name + "." + std::to_string(c);
    parts.push_back(emit(ir::Op::input, {}, input_index(input, ir::Rate::frame)));
  }
  if (knob.is_boolean) return truth(emit(ir::Op::fne, {parts.front(), constant(0)}));
  return parts.size() == 1 ? number(parts.front()) : vector(std::move(parts));
}

void Lowering::declare_knobs(const Program& program, ModuleScope& scope) {
  for (const StmtPtr& statement : program.body) {
    const auto* assign = statement ? std::get_if<AssignStmt>(&statement->node) : nullptr;
    const auto* name = assign ? std::get_if<NameExpr>(&assign->target->node) : nullptr;
    if (!name) continue;
    if (assign->op == AssignOp::set && name->name.front() >= 'A' && name->name.front() <= 'Z')
      declare_knob(*assign, name->name, statement->span, scope);
  }
}

void Lowering::declare_knob(const AssignStmt& assign, const std::string& name, const Span& span,
                            ModuleScope& scope) {
  if (scope.knobs.contains(name)) {
    if (!assign.meta.empty())
      error("knob-twice", span, "knob `" + name + "` is declared twice");
    return;
  }
  const auto value = constant_value(*assign.value);
  if (!value) {
    if (!assign.meta.empty())
      error("knob-value", assign.value->span, "a knob's value must be a constant",
            "write a number, a vector of numbers or a text");
    return;
  }
  // Of what a module sets twice, the last counts.
  if (&scope != &main_ && scope.constants[name] != assign.value.get()) return;
  Knob knob;
  knob.name = name;
  for (const Knob& other : knobs_)
    if (other.name == name) knob.name = scope.name + "." + name;
  knob.span = span;
  knob.is_boolean = value->is_boolean;
  knob.value = value->numbers;
  knob.text = value->text;
  if (value->is_text)
    for (const auto& [overridden, text] : options_.text_knobs)
      if (overridden == knob.name) knob.text = text;
  read_meta(knob, assign);
  scope.knobs[name] = knobs_.size();
  knobs_.push_back(std::move(knob));
}

void Lowering::read_meta(Knob& knob, const AssignStmt& assign) {
  const std::vector<std::string> known_names = {"min",    "max",     "label", "help",
                                                "widget", "options", "units", "page"};
  for (const MetaEntry& entry : assign.meta) {
    const auto value = entry.value ? constant_value(*entry.value) : std::nullopt;
    const bool wants_number = entry.name == "min" || entry.name == "max";
    if (std::find(known_names.begin(), known_names.end(), entry.name) == known_names.end()) {
      warning("unknown-meta", entry.span, "knobs have no property `" + entry.name + "`",
              did_you_mean(entry.name, known_names));
      continue;
    }
    if (!value || value->is_text == wants_number || (wants_number && value->numbers.size() != 1)) {
      error("meta-value", entry.span,
            "`" + entry.name + "` of a knob is " + (wants_number ? "a number" : "a text"));
      continue;
    }
    if (entry.name == "min") knob.min = value->numbers.front();
    if (entry.name == "max") knob.max = value->numbers.front();
    if (entry.name == "label") knob.label = value->text;
    if (entry.name == "help") knob.help = value->text;
    if (entry.name == "widget") knob.widget = value->text;
    if (entry.name == "units") knob.units = value->text;
    if (entry.name == "page") knob.page = value->text;
    if (entry.name == "options") {
      std::string option;
      for (const char letter : value->text + "|") {
        if (letter != '|') {
          option += letter;
        } else {
          knob.options.push_back(std::exchange(option, {}));
        }
      }
    }
  }
  if (knob.min && knob.max && *knob.min > *knob.max)
    error("meta-value", knob.span, "the range of knob `" + knob.name + "` ends before it begins");
  else
    check_range(knob);
}

// The program's own value should be one that the knob says it takes.
void Lowering::check_range(const Knob& knob) {
  const std::string its = "the value of knob `" + knob.name + "` is ";
  if (!knob.options.empty() && std::ranges::find(knob.options, knob.text) == knob.options.end())
    warning("knob-range", knob.span, its + "none of its options");
  const auto any = [&](const auto& wrong) { return std::ranges::any_of(knob.value, wrong); };
  if (knob.min && any([&](float value) { return value < *knob.min; }))
    warning("knob-range", knob.span, its + "below its minimum");
  if (knob.max && any([&](float value) { return value > *knob.max; }))
    warning("knob-range", knob.span, its + "above its maximum");
}

// ---- Outputs ------------------------------------------------------------------------------------

// As many channels as a reader takes (image/reader.h); the compiler's time grows with their square.
constexpr std::size_t most_outputs = 1024;

void Lowering::make_outputs(Lowered& result) {
  for (const std::string& name : output_order_) {
    // Single capitals are layers with names that pictures have always used: N, P, Z.
    const char first = name.front();
    if (first == '_' || (first >= 'A' && first <= 'Z' && name.size() > 1)) continue;
    const auto found = variables().find(name);
    if (found == variables().end()) continue;
    const Typed value = to_number(found->second);
    const bool is_colour =
        value.kind == Kind::number || (value.kind == Kind::vector && value.rows <= 4);
    const bool fits = name == "color" ? is_colour : name != "alpha" || value.kind == Kind::number;
    if (!fits && !value.is_error())
      error("output-kind", set_at_top_[name],
            "`" + name + "` is " + describe(value) + ", which makes no picture",
            value.kind == Kind::function ? "call the function" : "");
    if (!value.is_numeric()) continue;
    const bool wanted =
        options_.outputs.empty() ||
        std::find(options_.outputs.begin(), options_.outputs.end(), name) != options_.outputs.end();
    result.outputs.push_back({name, value.components(), set_at_top_[name]});
    if (!wanted) {
      result.outputs.pop_back();
      continue;
    }
    if (module_.outputs.size() + value.parts.size() > most_outputs)
      return error("too-many-outputs", set_at_top_[name],
                   "the program sets more than " + std::to_string(most_outputs) +
                       " numbers up to here, which is as many channels as an image has",
                   "a name that begins with `_` is not put out");
    for (int c = 0; c < value.components(); ++c) {
      module_.outputs.push_back({value.components() == 1 ? name : name + "." + std::to_string(c)});
      builder_->function().body.yields.push_back(value.parts[static_cast<std::size_t>(c)]);
    }
  }
}

Lowered Lowering::run(const Program& program) {
  Lowered result;
  main_.file = program.file;
  top_.scope = &main_;
  top_.body = &program.body;
  call_ = &top_;
  builder_ = std::make_unique<ir::Builder>(module_, module_.functions.front());
  builtins_ = std::make_unique<BuiltinEmitter>(module_);
  library_module_of("");
  try {
    read_definitions(program, main_);
    declare_knobs(program, main_);
    for (ModuleScope* module : imported_) declare_knobs(*module->program, *module);
    collect_assigned(program.body, ever_set_at_top_);
    bind_arrays(program.body);
    lower_block(program.body);
    make_outputs(result);
  } catch (const TooLarge&) {
    // Already reported.
  }

  // Module functions that the builtins added are in place; arrays nothing was put into have one
  // component.
  for (ir::Array& array : module_.functions.front().arrays)
    if (array.components == 0) array.components = 1;
  result.module = std::move(module_);
  result.knobs = std::move(knobs_);
  result.reads = std::move(reads_);
  result.calls = std::move(ranges_);
  return result;
}

}  // namespace pse::lower

namespace pse {

Lowered lower_program(SourceMap& sources, const lang::Program& program, const LowerHost& host,
                      const LowerOptions& options, Diagnostics& diagnostics) {
  Diagnostics found;
  Lowered lowered = lower::Lowering(sources, host, options, found).run(program);

  // Of the errors that one call of the library makes, loops may have kept several. A name that is
  // like no other is unknown wherever it is read, and one definition mends all places.
  std::vector<Span> calls;
  std::set<std::string> unknown;
  for (const Diagnostic& diagnostic : found.all()) {
    if (diagnostic.code == "unknown-name" && !diagnostic.suggestion.starts_with("did you mean") &&
        !unknown.insert(diagnostic.message).second)
      continue;
    if (diagnostic.severity == Severity::error && diagnostic.suggestion.contains("see library/")) {
      if (std::ranges::find(calls, diagnostic.span) != calls.end()) continue;
      calls.push_back(diagnostic.span);
    }
    diagnostics.add(diagnostic);
  }
  // Errors beyond those kept are counted; where there is room again, a repetition does no harm.
  const auto kept = std::ranges::count(found.all(), Severity::error, &Diagnostic::severity);
  for (auto more = static_cast<std::ptrdiff_t>(found.error_count()) - kept; more > 0; --more)
    diagnostics.add(*std::ranges::find(found.all(), Severity::error, &Diagnostic::severity));
  return lowered;
}

void add_later_errors(SourceMap& sources, const lang::Program& program, const LowerHost& host,
                      const LowerOptions& options, Diagnostics& diagnostics) {
  Diagnostics later;
  lower_program(sources, program, host, options, later);
  // What is found on a line that was not understood, or about what is missing, is a consequence.
  const std::vector<Diagnostic> earlier = diagnostics.all();
  const auto line = [&](const Span& span) {
    return sources.file(span.file).position(span.begin).line;
  };
  const auto follows = [&](const Diagnostic& found) {
    return found.code == "output-kind" || found.code == "no-value" ||
           std::ranges::any_of(earlier, [&](const Diagnostic& before) {
             return before.severity == Severity::error && found.span.valid() &&
                    found.span.file == before.span.file && line(found.span) == line(before.span);
           });
  };
  for (const Diagnostic& diagnostic : later.all()) {
    if (follows(diagnostic)) continue;
    const bool unknown = diagnostic.code == "unknown-name" || diagnostic.code == "unknown-function";
    if (diagnostic.severity == Severity::error &&
        (!unknown || diagnostic.suggestion.starts_with("did you mean")))
      diagnostics.add(diagnostic);
  }
  diagnostics.sort();
}

}  // namespace pse
