// Text -> module. See text.h for the form. Words are separated by white space, `#` starts a
// comment.
#include <charconv>
#include <limits>
#include <unordered_map>
#include <utility>

#include "ir/evaluate.h"
#include "ir/text.h"

namespace pse::ir {
namespace {

// A value's number may not be far beyond what the text defines, so that a short text cannot ask for
// all memory.
constexpr std::uint32_t max_value = 1u << 24;
constexpr int max_depth = 200;

struct Failure {
  std::string sentence;
};

// Cuts text into words: a quoted string, one of ( ) { } =, or a run of other characters.
class Words {
 public:
  explicit Words(std::string_view text) : text_(text) { advance(); }

  std::string_view peek() const { return word_; }
  bool at_end() const { return word_.empty(); }
  bool on_new_line() const { return new_line_; }  // whether the word is the first of its line

  std::string_view take() {
    if (at_end()) fail("more text was expected");
    const std::string_view word = word_;
    advance();
    return word;
  }
  bool take_if(std::string_view wanted) {
    if (word_ != wanted) return false;
    advance();
    return true;
  }
  void expect(std::string_view wanted) {
    if (!take_if(wanted)) fail("'" + std::string(wanted) + "' was expected");
  }
  [[noreturn]] void fail(const std::string& sentence) const {
    throw Failure{"line " + std::to_string(line_) + ": " + sentence + ", not '" +
                  std::string(word_) + "'"};
  }

 private:
  void advance() {
    new_line_ = begin_ == 0;
    skip_space();
    const std::size_t start = begin_;
    if (begin_ < text_.size()) {
      const char first = text_[begin_++];
      if (first == '"') {
        skip_quoted();
      } else if (!single(first)) {
        while (begin_ < text_.size() && !space(text_[begin_]) && !single(text_[begin_])) ++begin_;
      }
    }
    word_ = text_.substr(start, begin_ - start);
  }

  void skip_space() {
    while (begin_ < text_.size() && (space(text_[begin_]) || text_[begin_] == '#')) {
      if (text_[begin_] == '#') {
        while (begin_ < text_.size() && text_[begin_] != '\n') ++begin_;
        continue;
      }
      if (text_[begin_] == '\n') {
        ++line_;
        new_line_ = true;
      }
      ++begin_;
    }
  }

  void skip_quoted() {
    while (begin_ < text_.size() && text_[begin_] != '"') begin_ += text_[begin_] == '\\' ? 2 : 1;
    if (begin_ >= text_.size()) {
      begin_ = text_.size();
      throw Failure{"line " + std::to_string(line_) + ": a quoted name does not end"};
    }
    ++begin_;
  }

  static bool space(char c) { return c == ' ' || c == '\n' || c == '\t' || c == '\r'; }
  static bool single(char c) { return c == '(' || c == ')' || c == '{' || c == '}' || c == '='; }

  std::string_view text_;
  std::string_view word_;
  std::size_t begin_ = 0;
  int line_ = 1;
  bool new_line_ = true;
};

class Parser {
 public:
  explicit Parser(std::string_view text) : words_(text) {
    for (const OpInfo& op : op_table()) ops_.emplace(op.name, op.op);
  }

  Module run() {
    while (!words_.at_end()) item();
    return std::move(module_);
  }

 private:
  template <typename Number>
  Number number() {
    const std::string_view word = words_.peek();
    Number value{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || end != word.data() + word.size())
      words_.fail("a number was expected");
    words_.take();
    return value;
  }

  float floating() {
    const std::string_view word = words_.peek();
    if (word == "nan") {
      words_.take();
      return to_f32(nan_bits);
    }
    if (!word.starts_with("0x")) return number<float>();
    Bits bits = 0;
    const auto [end, error] = std::from_chars(word.data() + 2, word.data() + word.size(), bits, 16);
    if (error != std::errc{} || end != word.data() + word.size())
      words_.fail("a float's bits were expected");
    words_.take();
    return to_f32(bits);
  }

  std::string quoted() {
    if (!words_.peek().starts_with('"')) words_.fail("a quoted name was expected");
    const std::string_view word = words_.take();
    const auto digit = [](char c) { return c <= '9' ? c - '0' : (c | 32) - 'a' + 10; };
    std::string content;
    for (std::size_t i = 1; i + 1 < word.size(); ++i) {
      if (word[i] != '\\') {
        content += word[i];
      } else if (word[i + 1] == 'x' && i + 3 < word.size()) {
        content += static_cast<char>(digit(word[i + 2]) * 16 + digit(word[i + 3]));
        i += 3;
      } else {
        content += word[++i];
      }
    }
    return content;
  }

  Rate rate() {
    const std::string_view word = words_.peek();
    if (word != "constant" && word != "frame" && word != "sample")
      words_.fail("a rate was expected");
    words_.take();
    return word == "constant" ? Rate::constant : word == "frame" ? Rate::frame : Rate::sample;
  }

  Span span() {
    Span place;
    if (!words_.peek().starts_with('@')) return place;
    const std::string_view word = words_.peek();
    const char* end = word.data() + word.size();
    const auto file = std::from_chars(word.data() + 1, end, place.file);
    const auto begin = file.ptr < end ? std::from_chars(file.ptr + 1, end, place.begin) : file;
    const auto last = begin.ptr < end ? std::from_chars(begin.ptr + 1, end, place.end) : begin;
    if (last.ec != std::errc{} || last.ptr != end) words_.fail("a place was expected");
    words_.take();
    return place;
  }

  // One line of the module, or one function.
  void item() {
    const bool entry = words_.take_if("entry");
    const std::string_view kind = words_.take();
    if (entry && kind != "function") words_.fail("a function was expected");
    number<std::uint32_t>();  // its index, for the reader
    std::string name = quoted();
    if (kind == "table.f") {
      module_.float_tables.push_back({std::move(name), {}});
      while (!end_of_line()) module_.float_tables.back().entries.push_back(floating());
    } else if (kind == "table.i") {
      module_.int_tables.push_back({std::move(name), {}});
      while (!end_of_line()) module_.int_tables.back().entries.push_back(number<std::int32_t>());
    } else if (kind == "table.b") {
      module_.byte_tables.push_back({std::move(name), {}});
      while (!end_of_line()) module_.byte_tables.back().entries.push_back(number<std::uint8_t>());
    } else if (kind == "input") {
      module_.inputs.push_back({std::move(name), rate()});
    } else if (kind == "output") {
      module_.outputs.push_back({std::move(name)});
    } else if (kind == "check") {
      module_.checks.push_back({span(), std::move(name)});
    } else if (kind == "external") {
      const auto arguments = number<std::int32_t>();
      module_.externals.push_back({std::move(name), arguments, number<std::int32_t>()});
    } else if (kind == "function") {
      if (entry) module_.entry = static_cast<std::uint32_t>(module_.functions.size());
      function(std::move(name));
    } else {
      words_.fail("'" + std::string(kind) + "' is no part of a module");
    }
  }

  bool end_of_line() const { return words_.at_end() || words_.on_new_line(); }

  void function(std::string name) {
    function_ = {};
    function_.name = std::move(name);
    function_.body.params = params();
    words_.expect("{");
    while (words_.take_if("array")) {
      number<std::uint32_t>();
      Array array{.name = quoted()};
      array.components = number<std::int32_t>();
      array.capacity = number<std::int32_t>();
      array.initial_length = number<std::int32_t>();
      array.rate = rate();
      function_.arrays.push_back(std::move(array));
    }
    region_rest(function_.body);
    module_.functions.push_back(std::move(function_));
  }

  // `%12`, as a use.
  Value use() { return value_number(words_.take()); }

  Value value_number(std::string_view word) {
    Value value = no_value;
    const char* end = word.data() + word.size();
    const bool marked = word.starts_with('%');
    const auto read =
        marked ? std::from_chars(word.data() + 1, end, value) : std::from_chars_result{end, {}};
    if (!marked || read.ec != std::errc{} || read.ptr != end || value >= max_value)
      words_.fail("a value was expected");
    return value;
  }

  // `%12!c:f`, where a value is defined; `type` says whether one was written.
  Value definition(bool& typed) {
    std::string_view word = words_.take();
    ValueInfo info;
    typed = word.size() > 2 && word[word.size() - 2] == ':';
    if (typed) {
      info.type = type_of_letter(word.back());
      word.remove_suffix(2);
    }
    if (word.size() > 2 && word[word.size() - 2] == '!') {
      info.rate = word.back() == 'c'   ? Rate::constant
                  : word.back() == 'f' ? Rate::frame
                                       : Rate::sample;
      word.remove_suffix(2);
    }
    const Value value = value_number(word);
    if (value >= function_.values.size()) function_.values.resize(value + 1);
    function_.values[value] = info;
    return value;
  }

  Type type_of_letter(char letter) const {
    if (letter != 'f' && letter != 'i' && letter != 'b') words_.fail("a type was expected");
    return letter == 'f' ? Type::f32 : letter == 'i' ? Type::i32 : Type::boolean;
  }

  std::vector<Value> params() {
    std::vector<Value> values;
    if (!words_.take_if("(")) return values;
    while (!words_.take_if(")")) {
      bool typed = false;
      values.push_back(definition(typed));
      if (!typed) words_.fail("a parameter has a type");
    }
    return values;
  }

  void region(Region& content) {
    if (++depth_ > max_depth) words_.fail("the regions are nested too deeply");
    content.params = params();
    words_.expect("{");
    region_rest(content);
    --depth_;
  }

  // From after the brace to the closing brace.
  void region_rest(Region& content) {
    while (!words_.take_if("yield")) content.body.push_back(instruction());
    while (!words_.take_if("}")) content.yields.push_back(use());
  }

  Instruction instruction() {
    Instruction in;
    std::vector<bool> typed;
    while (words_.peek().starts_with('%')) {
      bool has_type = false;
      in.results.push_back(definition(has_type));
      typed.push_back(has_type);
    }
    if (!in.results.empty()) words_.expect("=");
    const auto found = ops_.find(words_.peek());
    if (found == ops_.end()) words_.fail("an operator was expected");
    words_.take();
    in.op = found->second;
    immediate(in);
    while (words_.peek().starts_with('%') && !words_.on_new_line()) in.operands.push_back(use());
    in.span = span();
    give_types(in, typed);
    regions(in);
    return in;
  }

  void immediate(Instruction& in) {
    switch (in.op) {
      case Op::const_f32:
        in.imm = std::bit_cast<std::int32_t>(floating());
        break;
      case Op::const_bool:
        in.imm = words_.peek() == "true";
        if (!words_.take_if("true")) words_.expect("false");
        break;
      case Op::array_load:
      case Op::array_store: {
        const std::string_view word = words_.take();
        const char* end = word.data() + word.size();
        const auto read = std::from_chars(word.data(), end, in.imm);
        const bool dotted = read.ec == std::errc{} && read.ptr < end && *read.ptr == '.';
        if (!dotted || std::from_chars(read.ptr + 1, end, in.component).ptr != end) {
          words_.fail("an array and its component were expected");
        }
        break;
      }
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
        in.imm = number<std::int32_t>();
        break;
      default:
        break;
    }
  }

  // Types of results that follow from the operator.
  void give_types(const Instruction& in, const std::vector<bool>& typed) {
    const std::string_view letters = info(in.op).results;
    for (std::size_t i = 0; i < in.results.size(); ++i) {
      if (typed[i]) continue;
      if (letters == "*" || i >= letters.size()) words_.fail("the type of a result is missing");
      Type& type = function_.values[in.results[i]].type;
      if (letters[i] != 'T') {
        type = type_of_letter(letters[i]);
      } else if (!in.operands.empty() && in.operands.back() < function_.values.size()) {
        type = function_.values[in.operands.back()].type;
      }
    }
  }

  void regions(Instruction& in) {
    if (in.op != Op::if_ && in.op != Op::loop) return;
    in.regions.resize(2);
    if (in.op == Op::loop) words_.expect("while");
    region(in.regions[0]);
    words_.expect(in.op == Op::loop ? "do" : "else");
    region(in.regions[1]);
  }

  Words words_;
  std::unordered_map<std::string_view, Op> ops_;
  Module module_;
  Function function_;
  int depth_ = 0;
};

}  // namespace

std::expected<Module, std::string> parse(std::string_view text) {
  try {
    return Parser(text).run();
  } catch (const Failure& failure) {
    return std::unexpected(failure.sentence);
  }
}

}  // namespace pse::ir
