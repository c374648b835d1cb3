#include "bench/scan_curves/embree_peers.h"

#include <functional>
#include <memory>
#include <semaphore>
#include <stop_token>
#include <thread>

#include "bench/bare_embree.h"

namespace simvis::bench {

namespace {

/// A thread that waits for work.
class Helper {
 public:
  ~Helper() {
    thread_.request_stop();
    begun_.release();
  }

  void begin(std::function<void()> work) {
    work_ = std::move(work);
    begun_.release();
  }
  void wait() { done_.acquire(); }

 private:
  void run(const std::stop_token& stop) {
    for (begun_.acquire(); !stop.stop_requested(); begun_.acquire()) {
      work_();
      done_.release();
    }
  }

  std::function<void()> work_;
  std::binary_semaphore begun_{0}, done_{0};
  std::jthread thread_{[this](const std::stop_token& stop) { run(stop); }};
};

/// The rays of all scans in the world, and their hits.
struct Rays {
  struct OfScan {
    glm::vec3 origin;
    std::vector<glm::vec3> directions;
    std::vector<float> ranges_m;
  };
  std::vector<OfScan> scans;

  void take(const std::vector<PeerScan>& peers) {
    scans.resize(peers.size());
    for (std::size_t i = 0; i < peers.size(); ++i) {
      const glm::dmat4& pose = peers[i].world_from_sensor;
      scans[i].origin = glm::vec3(pose[3]);
      scans[i].directions.clear();
      for (const glm::dvec3& direction : peers[i].directions) {
        scans[i].directions.emplace_back(glm::dmat3(pose) * direction);
      }
      scans[i].ranges_m.resize(peers[i].directions.size());
    }
  }

  std::vector<float> all_ranges() const {
    std::vector<float> all;
    for (const OfScan& scan : scans) all.insert(all.end(), scan.ranges_m.begin(), scan.ranges_m.end());
    return all;
  }
};

using Cast = void (BareEmbree::*)(std::span<const glm::vec3>, std::span<float>, const glm::vec3&) const;

/// Casts part `part` of `parts` of each scan, split between packets.
void cast_part(const BareEmbree& embree, Cast cast, Rays& rays, std::size_t part, std::size_t parts) {
  constexpr std::size_t kPacket = 16;
  for (Rays::OfScan& scan : rays.scans) {
    const std::size_t packets = (scan.directions.size() + kPacket - 1) / kPacket;
    const std::size_t first = packets * part / parts * kPacket;
    const std::size_t end = std::min(packets * (part + 1) / parts * kPacket, scan.directions.size());
    (embree.*cast)(std::span(scan.directions).subspan(first, end - first),
                   std::span(scan.ranges_m).subspan(first, end - first), scan.origin);
  }
}

}  // namespace

std::vector<Method> embree_methods(const DrawList& list, PeerScans& scans) {
  const auto embree = std::make_shared<BareEmbree>(list, glm::dmat4(1.0));
  const auto rays = std::make_shared<Rays>();
  const auto helper = std::make_shared<Helper>();
  std::vector<Method> methods;
  for (const auto& [name, cast] : {std::pair<const char*, Cast>{"embree 1", &BareEmbree::cast_singly},
                                   std::pair<const char*, Cast>{"embree 16", &BareEmbree::cast_in_packets}}) {
    const auto rest = [&scans] { scans.rest(); };
    const auto move = [&scans, rays](int frame) {
      scans.go_to(frame);
      rays->take(scans.scans());
    };
    const auto ranges_m = [rays] { return rays->all_ranges(); };
    methods.push_back({.name = name,
                       .max_error_rel = {},
                       .threads = 1,
                       .begin_turn = rest,
                       .move = move,
                       .set = [embree, rays, cast = cast] { cast_part(*embree, cast, *rays, 0, 1); },
                       .ranges_m = ranges_m});
    methods.push_back({.name = name,
                       .max_error_rel = {},
                       .threads = 2,
                       .begin_turn = rest,
                       .move = move,
                       .set =
                           [embree, rays, helper, cast = cast] {
                             helper->begin([&] { cast_part(*embree, cast, *rays, 1, 2); });
                             cast_part(*embree, cast, *rays, 0, 2);
                             helper->wait();
                           },
                       .ranges_m = ranges_m});
  }
  return methods;
}

}  // namespace simvis::bench
