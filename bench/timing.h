// Clocks and statistics of benchmarks.
#pragma once

#include <time.h>

#include <algorithm>
#include <chrono>
#include <vector>

namespace simvis::bench {

/// Time of some work in milliseconds: wall-clock time and processor time of the calling thread. On a CPU device the
/// driver draws on its own threads, so the latter is the time spent outside of drawing.
struct Took {
  double wall_ms = 0, caller_ms = 0;
};

inline double caller_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

inline double since_ms(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

template <typename Work>
Took time_work(const Work& work) {
  const double caller = caller_ms();
  const auto start = std::chrono::steady_clock::now();
  work();
  return {since_ms(start), caller_ms() - caller};
}

/// The quantile `share` of at least one value; 0.5 gives the median.
inline double quantile(std::vector<double> values, double share) {
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, place);
  return *place;
}

inline double median(const std::vector<double>& values) { return quantile(values, 0.5); }

inline Took median(const std::vector<Took>& all) {
  std::vector<double> wall, caller;
  for (const Took& took : all) {
    wall.push_back(took.wall_ms);
    caller.push_back(took.caller_ms);
  }
  return {median(wall), median(caller)};
}

}  // namespace simvis::bench
