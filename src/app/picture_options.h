// The options of the commands that make pictures, and those that several commands share. Parts of
// option_table.cpp's table.
#pragma once

#include "app/option_table.h"

namespace pse::app {

namespace options {

inline const OptionSpec help = {"h", "help", Takes::nothing, "",
                                "show this help; with a program also its knobs"};
inline const OptionSpec quiet = {"q", "quiet", Takes::nothing, "",
                                 "say nothing but warnings and errors"};
inline const OptionSpec include = {"I",
                                   "include",
                                   Takes::many,
                                   "DIR",
                                   "look for modules and files here too, before PSE_PATH",
                                   {},
                                   Offer::directory};
inline const OptionSpec define = {
    "D", "define",   Takes::many, "Name=VALUE", "set a knob; the same as Name=VALUE alone",
    {},  Offer::knob};
inline const OptionSpec warn = {
    "W", "warn", Takes::many, "WHICH",
    "`error` makes warnings errors (exit 6), `no-NAME` hides those called NAME, `none` hides all"};
inline const OptionSpec json = {"", "json", Takes::nothing, "", "print JSON instead of text"};
inline const OptionSpec threads = {
    "t", "threads",      Takes::one,   "N", "threads to compute with; 0: all",
    {},  Offer::nothing, "PSE_THREADS"};

}  // namespace options

std::vector<OptionSpec> render_options();
std::vector<OptionSpec> bake_options();
// Those of render that a traced picture has a use for.
std::vector<OptionSpec> trace_options();

}  // namespace pse::app
