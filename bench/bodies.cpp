// Measures what elements add to the engine of rigid bodies.
//
//   bodies [FRAMES]
//
// Prints CSV. A thousand boxes fall into a heap, once by elements of a scene, once by Bullet alone with its own
// contacts and the same steps, shapes and masses, in turn: a frame of 40 steps of 1 ms each. `ms_per_step` is the
// median over the frames, in processor time; `ratio_to_bare` is the ratio of the sums. `height_m` is the mean height at
// the end, which shows that both are the same heap.
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "simvis/element_motion.h"
#include "simvis/scene_builder.h"

namespace {

using namespace simvis;

constexpr int kSide = 10, kBoxes = kSide * kSide * kSide, kSteps = 40;
constexpr double kEdge_m = 0.2, kGap_m = 0.22, kStep_s = 1e-3;

glm::dvec3 start_of(int i) {
  const int x = i % kSide, y = i / kSide % kSide, z = i / (kSide * kSide);
  return {kGap_m * x + 0.03 * (z % 3), kGap_m * y + 0.02 * (z % 2), 0.3 + kGap_m * z};
}

class ByElements {
 public:
  ByElements() : built_(build_scene(parse_commands(scene(), "bodies", ""))) { advance_elements(built_, {}); }
  void frame() {
    time_ns_ += std::int64_t{kSteps} * 1'000'000;
    advance_elements(built_, {.time_ns = time_ns_});
  }
  double height() const {
    double sum = 0;
    for (int i = 0; i < kBoxes; ++i) {
      sum += start_of(i).z + built_.parameters.values()[built_.parameters.index("B" + std::to_string(i), "z")];
    }
    return sum / kBoxes;
  }

 private:
  static std::string scene() {
    std::string xml =
        "<element type='physics' name='P' insert_at='ROOT'/>"
        "<part name='F' insert_at='ROOT' shape='box' size='100 100 2' pose_offset='0 0 -1 0 0 0'/>"
        "<element type='body' name='FB' insert_at='F' kind='static' shape='box'/>";
    for (int i = 0; i < kBoxes; ++i) {
      const std::string n = std::to_string(i);
      const glm::dvec3 at = start_of(i);
      xml += "<part name='" + n + "' insert_at='ROOT' shape='box' size='0.2 0.2 0.2' pose_offset='" +
             format_number(at.x) + " " + format_number(at.y) + " " + format_number(at.z) +
             " 0 0 0'/><element type='body' name='B" + n + "' insert_at='" + n + "' shape='box' mass='1'/>";
    }
    return xml;
  }
  BuiltScene built_;
  std::int64_t time_ns_ = 0;
};

class Bare {
 public:
  Bare() : dispatcher_(&configuration_), world_(&dispatcher_, &broadphase_, &solver_, &configuration_) {
    world_.setGravity({0, 0, -9.80665});
    world_.getSolverInfo().m_numIterations = 50;
    box_.setMargin(kMargin_m);
    floor_.setMargin(kMargin_m);
    add(floor_, {0, 0, -1}, 0);
    for (int i = 0; i < kBoxes; ++i) {
      const glm::dvec3 at = start_of(i);
      add(box_, {at.x, at.y, at.z}, 1);
    }
  }
  ~Bare() {
    for (const auto& body : bodies_) world_.removeRigidBody(body.get());
  }
  void frame() {
    for (int i = 0; i < kSteps; ++i) world_.stepSimulation(kStep_s, 0);
  }
  double height() const {
    double sum = 0;
    for (std::size_t i = 1; i < bodies_.size(); ++i) sum += bodies_[i]->getWorldTransform().getOrigin().z();
    return sum / kBoxes;
  }

 private:
  static constexpr double kMargin_m = 1e-3;  // as elements/dynamics/bullet/bullet_shape.cpp
  void add(btCollisionShape& shape, const btVector3& at, double mass) {
    btVector3 inertia(0, 0, 0);
    if (mass > 0) inertia = btVector3(1, 1, 1) * (mass * kEdge_m * kEdge_m / 6);
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, &shape, inertia);
    info.m_startWorldTransform = btTransform(btQuaternion::getIdentity(), at);
    info.m_friction = 0.7;
    bodies_.push_back(std::make_unique<btRigidBody>(info));
    bodies_.back()->setActivationState(DISABLE_DEACTIVATION);
    world_.addRigidBody(bodies_.back().get());
  }
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_;
  btBoxShape box_{btVector3(1, 1, 1) * (kEdge_m / 2)}, floor_{btVector3(50, 50, 1)};
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
};

template <typename World>
double frame_ms(World& world) {
  const std::clock_t start = std::clock();
  world.frame();
  return 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

}  // namespace

int main(int count, char** arguments) {
  const int frames = count > 1 ? std::atoi(arguments[1]) : 50;
  ByElements elements;
  Bare bare;
  std::vector<double> elements_ms, bare_ms;
  for (int i = 0; i < frames; ++i) {
    bare_ms.push_back(frame_ms(bare));
    elements_ms.push_back(frame_ms(elements));
  }
  const double sum = std::accumulate(elements_ms.begin(), elements_ms.end(), 0.0),
               bare_sum = std::accumulate(bare_ms.begin(), bare_ms.end(), 0.0);
  std::printf("way,bodies,frames,ms_per_step,ratio_to_bare,height_m\n");
  std::printf("bare,%d,%d,%.4f,1,%.4f\n", kBoxes, frames, median(bare_ms) / kSteps, bare.height());
  std::printf("elements,%d,%d,%.4f,%.4f,%.4f\n", kBoxes, frames, median(elements_ms) / kSteps, sum / bare_sum,
              elements.height());
  return 0;
}
