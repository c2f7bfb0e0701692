// The lowering's state and steps. One object lowers one program; its members are grouped by file.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "ir/builder.h"
#include "lower/builtins.h"
#include "lower/library.h"
#include "lower/lower.h"
#include "lower/scan.h"
#include "lower/value.h"

namespace pse::lower {

// Thrown inside the lowering when a program outgrows its limits; never leaves lower().
struct TooLarge {};

struct CallArgument {
  std::string name;  // empty: positional
  Span span;
  Typed value;
};

// One function call being lowered, or the top level.
struct Call {
  const lang::FunctionStmt* definition = nullptr;  // null: top level
  ModuleScope* scope = nullptr;
  const lang::Block* body = nullptr;
  Variables variables;
  std::vector<Typed> functions;  // the functions among the arguments
  Call* caller = nullptr;
  Span call_span;
  const std::vector<CallArgument>* arguments = nullptr;  // as they were given
  std::string unmet;  // the text of a require() in it that is known to fail
};

// Where an error is to be looked for and how it is told.
struct Blame {
  Span span;
  std::string message;
  std::string suggestion;
};

class Lowering {
 public:
  Lowering(SourceMap& sources, const LowerHost& host, const LowerOptions& options,
           Diagnostics& diagnostics);
  Lowered run(const lang::Program& program);

 private:
  // lowering.cpp: the top level, modules, inputs, knobs, outputs.
  void read_definitions(const lang::Program& program, ModuleScope& scope);
  ModuleScope* load_module(const std::string& name, const Span& span);
  ModuleScope* library_module_of(const std::string& name);
  ModuleScope* adopt(FileId file, const std::string& name);
  ModuleScope* adopt_library(const LibraryFile& file, const std::string& name);
  void declare_knobs(const lang::Program& program, ModuleScope& scope);
  void declare_knob(const lang::AssignStmt& assign, const std::string& name, const Span& span,
                    ModuleScope& scope);
  void read_meta(Knob& knob, const lang::AssignStmt& assign);
  void check_range(const Knob& knob);
  void make_outputs(Lowered& result);
  const StreamName* stream_name(const std::string& name) const;
  Typed read_stream(const StreamName& name);
  Typed read_knob(std::size_t index);
  std::int32_t input_index(const std::string& name, ir::Rate rate,
                           ir::InputSlopes slopes = ir::InputSlopes::none);

  // names.cpp
  Typed lower_name(const std::string& name, const Span& span);
  std::optional<FunctionRef> find_function(const std::string& name, ModuleScope* scope);
  Typed lower_module_constant(ModuleScope* scope, const std::string& name, const Span& span,
                              bool& found);
  std::vector<std::string> visible_names() const;
  std::vector<std::string> callable_names() const;
  static std::string foreign_function(const std::string& name);
  std::string source_of(const std::string& name) const;
  std::string did_you_mean(const std::string& name,
                           const std::vector<std::string>& candidates) const;

  // expressions.cpp
  Typed lower(const lang::Expr& expr);
  Typed lower_node(const lang::Expr& expr);
  Typed lower_vector(const std::vector<lang::ExprPtr>& elements, const Span& span);
  Typed lower_binary(const lang::Expr& expr, const lang::BinaryExpr& binary);
  Typed lower_logical(const lang::Expr& expr, const lang::BinaryExpr& binary);
  Typed lower_conditional(const lang::ConditionalExpr& conditional, const Span& span);
  Typed lower_index(const lang::IndexExpr& index, const Span& span);
  Typed lower_member(const lang::MemberExpr& member, const Span& span);
  Typed element_of(const Typed& base, const Typed& index, const Span& span,
                   const std::string& what);

  std::int32_t constant_table(std::vector<float> entries);

  // arithmetic.cpp
  Typed arithmetic(lang::BinaryOp op, const Typed& a, const Typed& b, const Span& span);
  Typed compare(lang::BinaryOp op, const Typed& a, const Typed& b, const Span& span);
  Typed matrix_product(const Typed& a, const Typed& b, const Span& span);
  ir::Value scalar_op(lang::BinaryOp op, ir::Value a, ir::Value b);
  ir::Value power(ir::Value a, ir::Value b);
  Typed negate(const Typed& a, const Span& span);
  Typed number(float value);
  Typed number(ir::Value value);
  Typed truth(ir::Value value);
  Typed vector(std::vector<ir::Value> parts);
  Typed to_number(const Typed& value);  // truth values become 1 and 0, vectors stay
  Typed to_truth(const Typed& value, const Span& span);
  ir::Value to_index(const Typed& value);  // a number that counts from 1, as an integer from 0
  std::optional<float> known(ir::Value value) const;
  Typed promote(const Typed& value, const Typed& shape);  // number -> vector, truth -> number
  std::optional<Typed> common_shape(const Typed& a, const Typed& b) const;
  Typed zero_of(const Typed& shape);

  // calls.cpp
  Typed lower_call(const lang::CallExpr& call, const Span& span);
  Typed call_function(const FunctionRef& function, std::vector<CallArgument> arguments,
                      const Span& span, const std::string& name);
  Typed call_user(const FunctionRef& function, std::vector<CallArgument>& arguments,
                  const Span& span);
  Typed call_builtin(const std::string& name, std::vector<CallArgument>& arguments,
                     const Span& span);

  // intrinsics.cpp: builtins that depend on shapes.
  bool is_intrinsic(const std::string& name) const;
  std::vector<std::string> intrinsic_names() const;
  Typed call_intrinsic(const std::string& name, std::vector<CallArgument>& arguments,
                       const Span& span);
  Typed intrinsic_texture(std::vector<CallArgument>& arguments, const Span& span);
  Typed intrinsic_volume(std::vector<CallArgument>& arguments, const Span& span);
  Typed intrinsic_texture_size(const std::vector<CallArgument>& arguments);
  Typed slopes(const std::string& name, Typed value);
  Typed intrinsic_fold(const std::string& name, std::vector<CallArgument>& arguments,
                       const Span& span);

  // intrinsic_checks.cpp: what programs say of their own values.
  Typed intrinsic_require(const std::vector<CallArgument>& arguments, const Span& span);
  Typed intrinsic_expect(const std::vector<CallArgument>& arguments, const Span& span);

  // intrinsics_scene.cpp: rays into the scene.
  static bool is_scene_call(const std::string& name);
  Typed intrinsic_scene(const std::string& name, std::vector<CallArgument>& arguments,
                        const Span& span);
  std::optional<Typed> hit_part(const Typed& base, const std::string& name);

  // arrays.cpp
  Typed new_array(const std::string& name, std::int32_t capacity);
  Typed load_element(const Typed& array, ir::Value index, const Span& span, bool checked);
  void store_element(const Typed& array, ir::Value index, const Typed& value, const Span& span);
  Typed array_length(const Typed& array);
  Typed copy_array(const Typed& array, const std::string& name);
  void add_check(ir::Value condition, const std::string& message, const Span& span);

  // statements.cpp
  void lower_block(const lang::Block& block, std::size_t first = 0);
  void lower_statement(const lang::Stmt& statement);
  void lower_rest_guarded(const lang::Block& block, std::size_t next, const Exits& exits);
  void lower_if(const lang::IfStmt& statement, const Span& span, std::size_t branch,
                const std::function<void()>& rest, bool rest_in_fallthrough);
  void lower_assign(const lang::AssignStmt& assign, const Span& span);
  void warn_of_constant(const std::string& name, const Span& span);
  void assign_name(const std::string& name, Typed value, const Span& span);
  void assign_index(const lang::AssignStmt& assign, const lang::IndexExpr& index, const Span& span);
  void assign_member(const lang::AssignStmt& assign, const lang::MemberExpr& member,
                     const Span& span);
  Typed assigned_value(const lang::AssignStmt& assign, const std::function<Typed()>& current,
                       const Span& span);
  void lower_return(const lang::ReturnStmt& statement, const Span& span);
  void set_flag(const char* flag);
  void bind_arrays(const lang::Block& body);

  // branches.cpp: what structured control does to variables.
  void branch(ir::Value condition, const std::function<void()>& if_true,
              const std::function<void()>& if_false, const Span& span);
  Typed branch_value(ir::Value condition, const std::function<Typed()>& if_true,
                     const std::function<Typed()>& if_false, const Span& span);
  void loop(const std::set<std::string>& assigned, const lang::Block& body_block,
            const std::function<ir::Value()>& condition, const std::function<void()>& body,
            const Span& span);
  ir::Value flag_value(const char* flag);
  ir::Value not_left(const Exits& exits);  // true while none of these exits has been taken

  // loops.cpp
  void lower_while(const lang::WhileStmt& statement, const Span& span);
  void lower_for(const lang::ForStmt& statement, const Span& span);
  void counted_loop(const lang::ForStmt& statement, ir::Value count,
                    const std::function<Typed(ir::Value)>& element, const Span& span);

  Blame blame(const char* code, const Span& span, std::string message,
              std::string suggestion) const;
  void error(const char* code, const Span& span, std::string message, std::string suggestion = {});
  // The call in the program itself that led to a place in another file.
  Span program_place(const Span& span) const;
  void warning(const char* code, const Span& span, std::string message,
               std::string suggestion = {});
  Variables& variables() { return call_->variables; }
  ir::Value emit(ir::Op op, std::initializer_list<ir::Value> operands, std::int32_t imm = 0,
                 std::int32_t component = 0);
  ir::Value constant(float value);
  ir::Value integer(std::int32_t value);
  void check_size();

  SourceMap& sources_;
  const LowerHost& host_;
  const LowerOptions& options_;
  Diagnostics* diagnostics_;
  ir::Module module_;
  std::unique_ptr<ir::Builder> builder_;
  std::unique_ptr<BuiltinEmitter> builtins_;
  std::map<ir::Value, float> constants_;  // values known while lowering
  std::set<std::int32_t> given_up_;       // arrays that miss what errors kept out of them

  ModuleScope main_;
  // Imported modules, by name; null while loading or missing.
  std::map<std::string, std::unique_ptr<ModuleScope>> modules_;
  std::vector<ModuleScope*> imported_;                          // in the order of their imports
  std::map<std::string, int> library_index_;                    // function -> library file
  std::set<FileId> library_texts_;
  std::vector<Knob> knobs_;
  std::map<std::string, std::int32_t> inputs_;
  std::vector<ir::CallRange> ranges_;  // where calls were written
  std::unordered_map<const lang::FunctionStmt*, std::uint32_t> callees_;  // numbers for `ranges_`
  std::vector<std::string> reads_;
  std::set<std::string> ever_set_at_top_;   // all names set there, also further down
  std::map<std::string, Span> set_at_top_;  // outputs in the making: name -> last place
  std::vector<std::string> output_order_;
  Call top_;
  Call* call_ = nullptr;
  int loop_attempts_ = 0;
  int frame_blocks_ = 0;  // `if begin_frame` around here
  int depth_ = 0;
  int loop_depth_ = 0;
  int branch_depth_ = 0;
};

}  // namespace pse::lower
