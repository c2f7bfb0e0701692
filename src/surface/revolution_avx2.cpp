// For processors with AVX2, where the build knows how to compile for them.
#include "surface/revolution_packet.h"

namespace pse::surface::revolution {

FindFunction find_for_avx2() {
  return [](const Profile& profile, std::size_t count, const Ray* rays, Meeting* meetings) {
    find(profile, count, rays, meetings);
  };
}

}  // namespace pse::surface::revolution
