// Module -> text. See text.h for the form.
#include <charconv>
#include <cmath>

#include "ir/evaluate.h"
#include "ir/text.h"

namespace pse::ir {
namespace {

std::string_view rate_name(Rate rate) {
  return rate == Rate::constant ? "constant" : rate == Rate::frame ? "frame" : "sample";
}

class Printer {
 public:
  Printer(const Module& module, const TextOptions& options) : module_(module), options_(options) {}

  std::string run() {
    print_tables();
    for (std::size_t i = 0; i < module_.inputs.size(); ++i) {
      named("input", i, module_.inputs[i].name);
      text_.append(" ").append(rate_name(module_.inputs[i].rate)).append("\n");
    }
    for (std::size_t i = 0; i < module_.outputs.size(); ++i) {
      named("output", i, module_.outputs[i].name);
      text_ += '\n';
    }
    for (std::size_t i = 0; i < module_.checks.size(); ++i) {
      named("check", i, module_.checks[i].message);
      span(module_.checks[i].span);
      text_ += '\n';
    }
    for (std::size_t i = 0; i < module_.externals.size(); ++i) {
      named("external", i, module_.externals[i].name);
      number(module_.externals[i].arguments);
      number(module_.externals[i].results);
      text_ += '\n';
    }
    for (std::size_t i = 0; i < module_.functions.size(); ++i) print_function(i);
    return std::move(text_);
  }

 private:
  void number(std::int64_t value) { text_.append(" ").append(std::to_string(value)); }

  void quoted(std::string_view content) {
    constexpr std::string_view digits = "0123456789abcdef";
    text_ += '"';
    for (const char letter : content) {
      const auto byte = static_cast<unsigned char>(letter);
      if (letter == '"' || letter == '\\') {
        text_ += '\\';
        text_ += letter;
      } else if (byte < 32) {
        text_.append("\\x").append({digits[byte >> 4], digits[byte & 15]});
      } else {
        text_ += letter;
      }
    }
    text_ += '"';
  }

  void named(std::string_view kind, std::size_t index, std::string_view name) {
    text_.append(kind);
    number(static_cast<std::int64_t>(index));
    text_ += ' ';
    quoted(name);
  }

  // The shortest decimal that reads back as the same float; a NaN other than the usual one as its
  // bits.
  void floating(float value) {
    text_ += ' ';
    char digits[32];
    const Bits bits = to_bits(value);
    if (is_nan_bits(bits) && bits != nan_bits) {
      const auto end = std::to_chars(digits, digits + sizeof digits, bits, 16).ptr;
      text_.append("0x").append(digits, end);
    } else if (std::isnan(value)) {
      text_ += "nan";
    } else {
      text_.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
    }
  }

  void print_tables() {
    for (std::size_t i = 0; i < module_.float_tables.size(); ++i) {
      named("table.f", i, module_.float_tables[i].name);
      for (const float entry : module_.float_tables[i].entries) floating(entry);
      text_ += '\n';
    }
    for (std::size_t i = 0; i < module_.int_tables.size(); ++i) {
      named("table.i", i, module_.int_tables[i].name);
      for (const std::int32_t entry : module_.int_tables[i].entries) number(entry);
      text_ += '\n';
    }
    for (std::size_t i = 0; i < module_.byte_tables.size(); ++i) {
      named("table.b", i, module_.byte_tables[i].name);
      for (const std::uint8_t entry : module_.byte_tables[i].entries) number(entry);
      text_ += '\n';
    }
  }

  void span(const Span& place) {
    if (!options_.spans || !place.valid()) return;
    text_.append(" @")
        .append(std::to_string(place.file))
        .append(":")
        .append(std::to_string(place.begin));
    text_.append(":").append(std::to_string(place.end));
  }

  void print_function(std::size_t index) {
    function_ = &module_.functions[index];
    if (index == module_.entry) text_ += "entry ";
    named("function", index, function_->name);
    text_ += ' ';
    params(function_->body.params);
    text_ += "{\n";
    indent_ = 2;
    for (std::size_t i = 0; i < function_->arrays.size(); ++i) {
      const Array& array = function_->arrays[i];
      text_.append(indent_, ' ');
      named("array", i, array.name);
      number(array.components);
      number(array.capacity);
      number(array.initial_length);
      text_.append(" ").append(rate_name(array.rate)).append("\n");
    }
    region(function_->body);
    text_ += "}\n";
  }

  // A value where it is defined: with the mark of its rate, and its type where that does not
  // follow.
  void definition(Value value, bool with_type) {
    const ValueInfo& info = function_->values[value];
    text_.append("%").append(std::to_string(value));
    if (info.rate != Rate::sample) text_ += info.rate == Rate::constant ? "!c" : "!f";
    if (with_type) text_ += info.type == Type::f32 ? ":f" : info.type == Type::i32 ? ":i" : ":b";
  }

  void params(const std::vector<Value>& values) {
    if (values.empty()) return;
    text_ += '(';
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (i > 0) text_ += ' ';
      definition(values[i], true);
    }
    text_ += ") ";
  }

  void uses(const std::vector<Value>& values) {
    for (const Value value : values) text_.append(" %").append(std::to_string(value));
  }

  void region(const Region& content) {
    for (const Instruction& in : content.body) instruction(in);
    text_.append(indent_, ' ').append("yield");
    uses(content.yields);
    text_ += '\n';
  }

  void nested(const Region& content) {
    text_ += "{\n";
    indent_ += 2;
    region(content);
    indent_ -= 2;
    text_.append(indent_, ' ').append("}");
  }

  void instruction(const Instruction& in) {
    text_.append(indent_, ' ');
    for (const Value result : in.results) {
      definition(result, info(in.op).results == "*");
      text_ += ' ';
    }
    if (!in.results.empty()) text_ += "= ";
    text_ += info(in.op).name;
    immediate(in);
    uses(in.operands);
    span(in.span);
    regions(in);
    comment(in);
    text_ += '\n';
  }

  void immediate(const Instruction& in) {
    switch (in.op) {
      case Op::const_f32:
        floating(in.imm_f32());
        break;
      case Op::const_bool:
        text_ += in.imm ? " true" : " false";
        break;
      case Op::array_load:
      case Op::array_store:
        number(in.imm);
        text_.append(".").append(std::to_string(in.component));
        break;
      case Op::const_i32:
      case Op::input:
      case Op::slope:
      case Op::table_f32:
      case Op::table_i32:
      case Op::bytes_lookup:
      case Op::array_length:
      case Op::array_resize:
      case Op::check:
      case Op::call:
      case Op::external:
        number(in.imm);
        break;
      default:
        break;
    }
  }

  void regions(const Instruction& in) {
    if (in.op == Op::if_) {
      text_ += ' ';
      nested(in.regions[0]);
      text_ += " else ";
      nested(in.regions[1]);
    } else if (in.op == Op::loop) {
      text_ += " while ";
      params(in.regions[0].params);
      nested(in.regions[0]);
      text_ += " do ";
      params(in.regions[1].params);
      nested(in.regions[1]);
    }
  }

  // The names behind indices, for the reader.
  void comment(const Instruction& in) {
    const auto index = static_cast<std::size_t>(in.imm);
    std::string_view name;
    if (in.op == Op::input && index < module_.inputs.size()) name = module_.inputs[index].name;
    if (in.op == Op::call && index < module_.functions.size()) name = module_.functions[index].name;
    if (in.op == Op::external && index < module_.externals.size())
      name = module_.externals[index].name;
    if (in.op == Op::check && index < module_.checks.size()) name = module_.checks[index].message;
    if (name.empty() || name.find('\n') != std::string_view::npos) return;
    text_.append("  # ").append(name);
  }

  const Module& module_;
  const TextOptions& options_;
  const Function* function_ = nullptr;
  std::size_t indent_ = 0;
  std::string text_;
};

}  // namespace

std::string print(const Module& module, const TextOptions& options) {
  return Printer(module, options).run();
}

}  // namespace pse::ir
