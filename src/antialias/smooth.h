// The mean over a pixel of what bends between edges, from the samples around it: the convolution of
// the picture with the pixel's kernel, made of the nine samples that are there. It takes the place
// of more samples where the picture changes slowly enough for its samples to tell it.
#pragma once

#include "antialias/filter.h"

namespace pse::antialias {

// The mean is the middle and these parts of its bends: a bend is what two opposite neighbours have
// together more than twice the middle has.
struct Smoothing {
  float axis = 0;      // of the bends along the rows and along the columns
  float diagonal = 0;  // of those along both diagonals
};

// Exact for polynomials of the third degree, and nearest for those of the fourth, over all
// directions in which they may change. Nine samples reach no further than a variance of 1/4: wider
// kernels are taken as that wide.
Smoothing smoothing_of(const Filter& filter);

}  // namespace pse::antialias
