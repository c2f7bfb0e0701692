// For every processor.
#include "antialias/crossing_steps.h"
#include "antialias/fine_steps.h"
#include "antialias/half_steps.h"
#include "antialias/neighbours.h"
#include "antialias/sample_steps.h"
#include "antialias/smooth_steps.h"

namespace pse::antialias {

const Steps& steps_for_any() {
  static constexpr Steps these = {{search<8, 1>, search<8, 2>},
                                  find_fine<8>,
                                  smooth<8>,
                                  mean_of_halves<8>,
                                  see_nearness<4>,
                                  find_fates<4>,
                                  find_second_looks,
                                  look_again<4>,
                                  bend_shares<4>,
                                  find_sides,
                                  judge<4>,
                                  place,
                                  summarise};
  return these;
}

}  // namespace pse::antialias
