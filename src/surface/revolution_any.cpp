// For any processor.
#include "surface/revolution_packet.h"

namespace pse::surface::revolution {

FindFunction find_for_any() {
  return [](const Profile& profile, std::size_t count, const Ray* rays, Meeting* meetings) {
    find(profile, count, rays, meetings);
  };
}

}  // namespace pse::surface::revolution
