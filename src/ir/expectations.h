// What a program expects of its values and goes on without: expect() of the language. Where it is
// not so, the host is told of the pixel and the user gets a warning.
//
// The lowering writes expect() as a call of the external "expect K" with a condition and values,
// which gives the values back: whoever does not need them does not need the condition either. K is
// the index in Module::checks of what to say. A host that can report lets passes/
// settle_expectations turn the calls into effects: they are run where the condition is false, get
// the pixel and give nothing. All others drop them.
#pragma once

#include <optional>
#include <string>

#include "ir/module.h"

namespace pse::ir {

// The external's name, and back: the index K of an external of this name; nothing for others.
std::string expectation_name(std::int32_t check);
std::optional<std::int32_t> expectation_of(const External& external);

// Whether an instruction is such a call, in either form.
bool is_expectation(const Module& module, const Instruction& in);

bool has_expectations(const Module& module);

// Takes out those that hand values on, or all; the values take their place. Conditions and ifs that
// are left over are for passes/remove_dead.
void release_expected_values(Module& module);
void drop_expectations(Module& module);

}  // namespace pse::ir
