// For processors with AVX-512, where the build knows how to compile for them.
#include "antialias/crossing_steps.h"
#include "antialias/fine_steps.h"
#include "antialias/half_steps.h"
#include "antialias/neighbours.h"
#include "antialias/sample_steps.h"
#include "antialias/smooth_steps.h"

namespace pse::antialias {

const Steps& steps_for_avx512() {
  static constexpr Steps these = {{search<16, 1>, search<16, 2>},
                                  find_fine<16>,
                                  smooth<16>,
                                  mean_of_halves<16>,
                                  see_nearness<16>,
                                  find_fates<16>,
                                  find_second_looks,
                                  look_again<16>,
                                  bend_shares<16>,
                                  find_sides,
                                  judge<16>,
                                  place,
                                  summarise};
  return these;
}

}  // namespace pse::antialias
