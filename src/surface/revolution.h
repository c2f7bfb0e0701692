// The choice between the two ways in which a surface of revolution is met: the same for any
// processor and for those with AVX2.
#pragma once

#include "surface/shapes.h"

namespace pse::surface::revolution {

struct Profile;  // revolution_profile.h

// What rays meet, as Shape::find() wants it.
using FindFunction = void (*)(const Profile& profile, std::size_t count, const Ray* rays,
                              Meeting* meetings);
FindFunction find_for_any();
FindFunction find_for_avx2();

// make_revolution() (shapes.h) with one of them; that chooses by the processor.
std::shared_ptr<const Shape> make_for(const std::vector<ProfilePoint>& points, bool caps,
                                      FindFunction find);

}  // namespace pse::surface::revolution
