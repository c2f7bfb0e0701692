// The taking and giving.
#include "antialias/kept.h"

namespace pse::antialias {

std::shared_ptr<const Patterns> Kept::patterns(const Filter& filter, std::uint32_t samples) {
  const std::pair wanted(filter, samples);
  const std::lock_guard lock(mutex_);
  if (!patterns_ || patterns_of_ != wanted) {
    patterns_ = std::make_shared<const Patterns>(filter, samples);
    patterns_of_ = wanted;
  }
  return patterns_;
}

std::unique_ptr<Work> Kept::take() {
  const std::lock_guard lock(mutex_);
  if (works_.empty()) return std::make_unique<Work>();
  auto work = std::move(works_.back());
  works_.pop_back();
  return work;
}

void Kept::give(std::unique_ptr<Work> work) {
  work->inputs.clear();  // told apart by where programs are that run no more
  const std::lock_guard lock(mutex_);
  works_.push_back(std::move(work));
}

}  // namespace pse::antialias
