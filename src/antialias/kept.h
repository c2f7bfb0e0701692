// What a picture leaves for the next one of the same programs: the memory of its threads and the
// places of its samples. To touch new memory and to make the places takes as long as ten thousand
// pixels do.
#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "antialias/filter.h"
#include "antialias/patterns.h"
#include "antialias/places.h"

namespace pse::antialias {

// All may be called from several threads at once.
class Kept {
 public:
  // Those that were asked for last if they are the same, else new ones.
  std::shared_ptr<const Patterns> patterns(const Filter& filter, std::uint32_t samples);

  // Memory for one thread; what is in it has no meaning.
  std::unique_ptr<Work> take();
  // Gives it back. No program that it was used for need live on.
  void give(std::unique_ptr<Work> work);

 private:
  std::mutex mutex_;
  std::shared_ptr<const Patterns> patterns_;
  std::pair<Filter, std::uint32_t> patterns_of_;
  std::vector<std::unique_ptr<Work>> works_;  // those that are not in use
};

}  // namespace pse::antialias
