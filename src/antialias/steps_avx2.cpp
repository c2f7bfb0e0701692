// For processors with AVX2, where the build knows how to compile for them.
#include "antialias/crossing_steps.h"
#include "antialias/fine_steps.h"
#include "antialias/half_steps.h"
#include "antialias/neighbours.h"
#include "antialias/sample_steps.h"
#include "antialias/smooth_steps.h"

namespace pse::antialias {

const Steps& steps_for_avx2() {
  static constexpr Steps these = {{search<8, 1>, search<8, 2>},
                                  find_fine<8>,
                                  smooth<8>,
                                  mean_of_halves<8>,
                                  see_nearness<8>,
                                  find_fates<8>,
                                  find_second_looks,
                                  look_again<8>,
                                  bend_shares<8>,
                                  find_sides,
                                  judge<8>,
                                  place,
                                  summarise};
  return these;
}

}  // namespace pse::antialias
