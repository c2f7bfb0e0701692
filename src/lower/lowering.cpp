// The top level: definitions first, then knobs, then the statements in order; at the end the outputs.
#include "lower/lowering.h"

#include "lang/parser.h"
#include "lower/constant.h"
#include "lower/library.h"

namespace pse::lower {

using namespace lang;

Lowering::Lowering(SourceMap& sources, const LowerHost& host, const LowerOptions& options, Diagnostics& diagnostics)
    : sources_(sources), host_(host), options_(options), diagnostics_(&diagnostics) {
  module_.functions.reserve(BuiltinEmitter::room_for_builtins + 1);
  module_.functions.emplace_back();
  module_.functions.front().name = "main";
}

// ---- Reports and limits -----------------------------------------------------------------------------------------

void Lowering::error(const char* code, const Span& span, std::string message, std::string suggestion) {
  // In another file's function, the program's own call is the place to look at next.
  const Call* call = span.valid() && span.file != main_.file ? call_ : nullptr;
  while (call && call->call_span.file != main_.file) call = call->caller;
  if (call && call->call_span.valid())
    suggestion += (suggestion.empty() ? "called from " : "; called from ") + sources_.describe(call->call_span);
  diagnostics_->error(code, span, std::move(message), std::move(suggestion));
}

void Lowering::warning(const char* code, const Span& span, std::string message, std::string suggestion) {
  diagnostics_->warning(code, span, std::move(message), std::move(suggestion));
}

ir::Value Lowering::emit(ir::Op op, std::initializer_list<ir::Value> operands, std::int32_t imm,
                         std::int32_t component) {
  return builder_->emit(op, operands, imm, component);
}

void Lowering::check_size() {
  if (builder_->emitted() <= options_.max_instructions) return;
  error("too-large", builder_->span(),
        "the program grows beyond " + std::to_string(options_.max_instructions) + " operations here",
        "functions are copied into their callers: call large ones from a loop instead of many places");
  throw TooLarge{};
}

// ---- Modules ----------------------------------------------------------------------------------------------------

void Lowering::read_definitions(const Program& program, ModuleScope& scope) {
  const bool imported = &scope != &main_;
  for (const StmtPtr& statement : program.body) {
    if (!statement) continue;
    if (const auto* function = std::get_if<FunctionStmt>(&statement->node)) {
      if (!scope.functions.emplace(function->name, function).second)
        error("function-twice", function->name_span, "function `" + function->name + "` is defined twice");
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
      if (const auto* name = std::get_if<NameExpr>(&assign->target->node); name && assign->op == AssignOp::set)
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

ModuleScope* Lowering::load_module(const std::string& name, const Span& span) {
  if (const auto found = modules_.find(name); found != modules_.end()) return found->second.get();
  if (host_.find_module)
    if (const auto file = host_.find_module(sources_, name)) return adopt(*file, name);
  for (const LibraryFile& file : library_files())
    if (file.name == name) return adopt(sources_.add("library/" + name + ".pse", std::string(file.text)), name);
  error("unknown-module", span, "there is no module `" + name + "`",
        "a module is a file `" + name + ".pse` beside the program or on PSE_PATH");
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
  return adopt(sources_.add(key + ".pse", std::string(file.text)), key);
}

// ---- The stream and the knobs -----------------------------------------------------------------------------------

const StreamName* Lowering::stream_name(const std::string& name) const {
  for (const StreamName& candidate : options_.stream)
    if (candidate.name == name) return &candidate;
  return nullptr;
}

std::int32_t Lowering::input_index(const std::string& name, ir::Rate rate, ir::InputSlopes slopes) {
  const auto [found, fresh] = inputs_.emplace(name, static_cast<std::int32_t>(module_.inputs.size()));
  if (fresh) module_.inputs.push_back({name, rate, slopes});
  return found->second;
}

Typed Lowering::read_stream(const StreamName& name) {
  bool read = false;
  for (const std::string& known_name : reads_) read = read || known_name == name.name;
  if (!read) reads_.push_back(name.name);
  if (name.components == 1) return number(emit(ir::Op::input, {}, input_index(name.name, name.rate, name.slopes)));
  std::vector<ir::Value> parts;
  for (int c = 0; c < name.components; ++c)
    parts.push_back(emit(ir::Op::input, {}, input_index(name.name + "." + std::to_string(c), name.rate, name.slopes)));
  return vector(std::move(parts));
}

Typed Lowering::read_knob(const std::string& name) {
  const Knob& knob = knobs_[knob_of_.at(name)];
  if (knob.is_text()) return {.kind = Kind::text, .parts = {}, .text = knob.text, .function = {}};
  std::vector<ir::Value> parts;
  for (std::size_t c = 0; c < knob.value.size(); ++c) {
    const std::string input = knob.value.size() == 1 ? name : name + "." + std::to_string(c);
    parts.push_back(emit(ir::Op::input, {}, input_index(input, ir::Rate::frame)));
  }
  if (knob.is_boolean) return truth(emit(ir::Op::fne, {parts.front(), constant(0)}));
  return parts.size() == 1 ? number(parts.front()) : vector(std::move(parts));
}

void Lowering::declare_knob(const AssignStmt& assign, const std::string& name, const Span& span) {
  if (knob_of_.contains(name)) {
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
  Knob knob;
  knob.name = name;
  knob.span = span;
  knob.is_boolean = value->is_boolean;
  knob.value = value->numbers;
  knob.text = value->text;
  if (value->is_text)
    for (const auto& [overridden, text] : options_.text_knobs)
      if (overridden == name) knob.text = text;
  read_meta(knob, assign);
  knob_of_[name] = knobs_.size();
  knobs_.push_back(std::move(knob));
}

void Lowering::read_meta(Knob& knob, const AssignStmt& assign) {
  const std::vector<std::string> known_names = {"min", "max", "label", "help", "widget", "options", "units", "page"};
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
}

// ---- Outputs ----------------------------------------------------------------------------------------------------

void Lowering::make_outputs(Lowered& result) {
  for (const std::string& name : output_order_) {
    // Single capitals are layers with names that pictures have always used: N, P, Z.
    const char first = name.front();
    if (first == '_' || (first >= 'A' && first <= 'Z' && name.size() > 1)) continue;
    const auto found = variables().find(name);
    if (found == variables().end()) continue;
    const Typed value = to_number(found->second);
    if (!value.is_numeric()) continue;
    const bool wanted = options_.outputs.empty() ||
                        std::find(options_.outputs.begin(), options_.outputs.end(), name) != options_.outputs.end();
    result.outputs.push_back({name, value.components(), set_at_top_[name]});
    if (!wanted) {
      result.outputs.pop_back();
      continue;
    }
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
    for (const StmtPtr& statement : program.body) {
      const auto* assign = statement ? std::get_if<AssignStmt>(&statement->node) : nullptr;
      const auto* name = assign ? std::get_if<NameExpr>(&assign->target->node) : nullptr;
      if (!name) continue;
      if (assign->op == AssignOp::set && name->name.front() >= 'A' && name->name.front() <= 'Z')
        declare_knob(*assign, name->name, statement->span);
      else if (!assign->meta.empty())
        error("knob-name", assign->target->span, "a knob's name begins with a capital letter");
    }
    bind_arrays(program.body);
    lower_block(program.body);
    make_outputs(result);
  } catch (const TooLarge&) {
    // Already reported.
  }

  // Module functions that the builtins added are in place; arrays nothing was put into have one component.
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

Lowered lower_program(SourceMap& sources, const lang::Program& program, const LowerHost& host, const LowerOptions& options,
              Diagnostics& diagnostics) {
  return lower::Lowering(sources, host, options, diagnostics).run(program);
}

void add_later_errors(SourceMap& sources, const lang::Program& program, const LowerHost& host,
                      const LowerOptions& options, Diagnostics& diagnostics) {
  Diagnostics later;
  lower_program(sources, program, host, options, later);
  for (const Diagnostic& diagnostic : later.all()) {
    const bool unknown = diagnostic.code == "unknown-name" || diagnostic.code == "unknown-function";
    if (diagnostic.severity == Severity::error && (!unknown || diagnostic.suggestion.starts_with("did you mean")))
      diagnostics.add(diagnostic);
  }
  diagnostics.sort();
}

}  // namespace pse
