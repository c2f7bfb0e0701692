// The math library. Every function is one template body for float, and for the values that write
// IR; see number.h.
#pragma once

#include "noise/exp_log.h"
#include "noise/hyperbolic.h"
#include "noise/power.h"
#include "noise/trig.h"
