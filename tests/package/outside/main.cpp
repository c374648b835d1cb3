// A program outside SimVis with an element of its own: a wall that can be pushed away. A laser scanner looks at it.
#include <simvis/element.h>
#include <simvis/error.h>
#include <simvis/simulation.h>

#include <cmath>
#include <cstdio>
#include <string>

namespace {

constexpr simvis::AttributeSpec kAttributes[] = {
    {.name = "x", .default_value = "4", .unit = "m", .text = "where the wall stands", .live = true},
    {.name = "paint", .kind = simvis::AttributeKind::text, .text = "colour; none is known"},
};

std::shared_ptr<const simvis::Mesh> square() {
  auto mesh = std::make_shared<simvis::Mesh>();
  mesh->positions = {{0, -1, -1}, {0, 1, -1}, {0, 1, 1}, {0, -1, 1}};
  mesh->attributes.assign(4, {.normal = {-1, 0, 0}});
  mesh->indices = {0, 2, 1, 0, 3, 2};
  simvis::compute_bounds(*mesh);
  return mesh;
}

class PushedWall : public simvis::Element {
 public:
  explicit PushedWall(const simvis::ElementContext& context) : transform_(std::make_shared<simvis::Transform>()) {
    if (context.attributes.is_set("paint")) throw simvis::InputError("there is no paint");
    auto group = std::make_shared<simvis::Separator>();
    group->add(transform_);
    group->add(std::make_shared<simvis::Shape>(square()));
    context.scene.insert(context.command, group);
  }
  void update(simvis::ParameterView values) override {
    glm::dmat4 matrix{1.0};
    matrix[3][0] = values[0];
    transform_->set_matrix(matrix);
  }

 private:
  std::shared_ptr<simvis::Transform> transform_;
};

const simvis::ElementRegistration kRegistration({
    .name = "pushed_wall",
    .summary = "a wall of 2 m x 2 m that can be pushed away",
    .attributes = kAttributes,
    .create = [](const simvis::ElementContext& context) -> std::unique_ptr<simvis::Element> {
      return std::make_unique<PushedWall>(context);
    },
});

constexpr char kScene[] = R"(
  <element type="pushed_wall" name="WALL" insert_at="ROOT"/>
  <sensor type="laser_scanner" name="SCANNER" insert_at="ROOT" samples="3" min_angle="-10" max_angle="10"/>
)";

/// Steps, prints the middle beam's range, and says whether the wall is where it should be.
bool looks_right(simvis::Simulation& simulation, double expected_m) {
  simulation.step();
  const simvis::Scan& scan = simulation.scan("SCANNER");
  std::printf("%.9g m, at most %.3g m off\n", scan.range_m[1], scan.error_bound_m[1]);
  return std::abs(scan.range_m[1] - expected_m) <= scan.error_bound_m[1];
}

/// Whether the errors of the library, and those of this program that pass through it, arrive as what they are.
bool errors_arrive() {
  const auto message = [](const char* attributes) -> std::string {
    try {
      simvis::Simulation::from_string("<element name='WALL' insert_at='ROOT' " + std::string(attributes) + "/>");
    } catch (const simvis::InputError& error) {
      return error.what();
    }
    return "";
  };
  const std::string of_library = message("type='pushed_wal'"), of_program = message("type='pushed_wall' paint='red'");
  std::printf("%s\n%s\n", of_library.c_str(), of_program.c_str());
  return of_library.find("did you mean \"pushed_wall\"?") != std::string::npos && of_program == "there is no paint";
}

}  // namespace

int main() {
  try {
    auto simulation = simvis::Simulation::from_string(kScene);
    const bool before = looks_right(simulation, 4);
    simulation.set("WALL", "x", 6.5);
    const bool after = looks_right(simulation, 6.5);
    return before && after && errors_arrive() ? 0 : 1;
  } catch (const simvis::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
