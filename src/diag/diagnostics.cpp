// Collecting diagnostics, putting them in order, and the nearest name for "did you mean".
#include "diag/diagnostics.h"

#include <algorithm>
#include <cctype>
#include <tuple>

namespace pse {

void Diagnostics::add(Diagnostic diagnostic) {
  const bool is_error = diagnostic.severity == Severity::error;
  if (is_error) ++errors_;

  // Errors and the rest have a limit each, so that a flood of warnings cannot hide an error.
  std::size_t& kept = is_error ? kept_errors_ : kept_others_;
  if (kept >= limit) return;
  ++kept;
  all_.push_back(std::move(diagnostic));
}

void Diagnostics::error(std::string code, Span span, std::string message, std::string suggestion) {
  add({Severity::error, std::move(code), std::move(message), span, {}, std::move(suggestion)});
}

void Diagnostics::warning(std::string code, Span span, std::string message,
                          std::string suggestion) {
  add({Severity::warning, std::move(code), std::move(message), span, {}, std::move(suggestion)});
}

void Diagnostics::sort() {
  const auto place = [](const Diagnostic& d) {
    return std::tuple(d.span.file, d.span.begin, d.span.end, -static_cast<int>(d.severity));
  };
  std::stable_sort(all_.begin(), all_.end(),
                   [&](const Diagnostic& a, const Diagnostic& b) { return place(a) < place(b); });

  // Repetitions share their place, but others found there may stand between them.
  const auto same = [](const Diagnostic& a, const Diagnostic& b) {
    return a.severity == b.severity && a.code == b.code && a.message == b.message &&
           a.span == b.span && a.expected == b.expected && a.suggestion == b.suggestion;
  };
  std::vector<Diagnostic> unique;
  for (Diagnostic& diagnostic : all_) {
    bool repeated = false;
    for (auto at = unique.rbegin(); at != unique.rend() && at->span == diagnostic.span && !repeated;
         ++at)
      repeated = same(*at, diagnostic);
    if (repeated)
      errors_ -= diagnostic.severity == Severity::error;
    else
      unique.push_back(std::move(diagnostic));
  }
  all_ = std::move(unique);
}

namespace {

// The Damerau-Levenshtein distance in its "optimal string alignment" form (one letter inserted,
// deleted, replaced, or two neighbours swapped), not counting case; gives up with `bound` + 1.
int edit_distance(std::string_view a, std::string_view b, int bound) {
  const int n = static_cast<int>(a.size()), m = static_cast<int>(b.size());
  if (n - m > bound || m - n > bound) return bound + 1;
  const auto letter = [](std::string_view s, int i) {
    return std::tolower(static_cast<unsigned char>(s[static_cast<std::size_t>(i)]));
  };
  const auto row_size = static_cast<std::size_t>(m) + 1;
  std::vector<int> before(row_size), previous(row_size), current(row_size);
  for (int j = 0; j <= m; ++j) previous[static_cast<std::size_t>(j)] = j;
  for (int i = 1; i <= n; ++i) {
    current[0] = i;
    int smallest = i;
    for (int j = 1; j <= m; ++j) {
      const auto at = static_cast<std::size_t>(j);
      const bool equal = letter(a, i - 1) == letter(b, j - 1);
      int best = std::min({previous[at] + 1, current[at - 1] + 1, previous[at - 1] + !equal});
      if (i > 1 && j > 1 && letter(a, i - 1) == letter(b, j - 2) &&
          letter(a, i - 2) == letter(b, j - 1))
        best = std::min(best, before[at - 2] + 1);
      current[at] = best;
      smallest = std::min(smallest, best);
    }
    if (smallest > bound) return bound + 1;
    before.swap(previous);
    previous.swap(current);
  }
  return previous.back();
}

// The shortest candidate of several words whose first or last the name is; first ones are better.
std::string longer_name(std::string_view name, const std::vector<std::string>& candidates) {
  constexpr std::size_t shortest = 3;
  if (name.size() < shortest) return {};
  std::string_view best;
  std::tuple<bool, std::size_t, std::string_view> best_rank;
  for (const std::string& candidate : candidates) {
    const bool begins = candidate.starts_with(std::string(name) + "_");
    if (!begins && !candidate.ends_with("_" + std::string(name))) continue;
    const std::tuple rank(!begins, candidate.size(), std::string_view(candidate));
    if (best.empty() || rank < best_rank) best = candidate, best_rank = rank;
  }
  return std::string(best);
}

}  // namespace

std::string nearest_name(std::string_view name, const std::vector<std::string>& candidates) {
  // A third of the letters may be wrong; names that long are not typed by hand.
  constexpr std::size_t longest = 64;
  if (name.empty() || name.size() > longest) return {};
  int bound = std::max<int>(1, static_cast<int>(name.size()) / 3);
  if (name.size() == 1) bound = 0;

  std::string_view best;
  std::tuple<int, bool, std::string_view> best_rank;
  for (const std::string& candidate : candidates) {
    if (candidate == name) continue;
    const int distance = edit_distance(name, candidate, bound);
    if (distance > bound) continue;
    const std::tuple rank(distance, candidate.front() != name.front(), std::string_view(candidate));
    if (best.empty() || rank < best_rank) best = candidate, best_rank = rank;
  }
  return best.empty() ? longer_name(name, candidates) : std::string(best);
}

}  // namespace pse
