// What only one branch of an if uses is computed there: a floor that picks a random number for one
// part of the picture is then no decision in the others, where neighbours need not differ by it
// (2002 chapter: paths differ "at conditional statements" that are met).
#pragma once

#include "ir/module.h"

namespace pse::antialias {

// Moves instructions of the main function without effects into the branches that alone use their
// results; but no cut that decides otherwise than by a random number, since where such a one falls
// differently there may be something that no sample has met. Values keep their names, and the
// module its meaning bit for bit.
void sink_into_branches(ir::Module& module);

}  // namespace pse::antialias
