// Measures what other processes do to a served simulation and the other way round.
//
//   serving [WRITES [CHECKS [BLOCKS [PARTS]]]]
//
// Prints CSV, one table for each question:
//   WRITES  by a client at random moments: the time until a scan shows it, with a histogram, while the host makes
//           frames as fast as it can
//   CHECKS  of poses that four processes write together with single values, 1,000 parameters at 1 kHz: how many were
//           torn, out of order or lost
//   BLOCKS  of 30 frames of marvin at 15 Hz, in turn without and with a follower that is killed and started again at
//           random: what a frame takes, and whether the scans are those of a simulation without followers. Where
//           other programs use the processor, processor time says more than the wall clock
//   PARTS   of a scene: how long the program takes to open it as a host, and how long as its follower, until the first
//   frame
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "bench/serving/parts.h"

int main(int argc, char** argv) {
  using namespace simvis::bench;
  const auto argument = [&](int i, int otherwise) { return argc > i ? std::atoi(argv[i]) : otherwise; };
  try {
    measure_latency(argument(1, 1000));
    std::puts("");
    measure_updates(static_cast<std::size_t>(argument(2, 18'000'000)));
    std::puts("");
    measure_follower(argument(3, 20));
    std::puts("");
    measure_opening(argument(4, 10'000));
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "serving: %s\n", error.what());
    return 1;
  }
}
