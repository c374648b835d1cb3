// Random sequences of commands and parameter changes: the scene that is flattened after each of them equals the scene
// that executes the same commands without being flattened between them, draw list for draw list. Both execute them one
// by one, because names of copies differ if one list of commands inserts several.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "scenegraph/flattener.h"
#include "simvis/live_scene.h"
#include "tests/support/long_count.h"
#include "tests/support/object_names.h"
#include "tests/support/parts/stub_part.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("scenegraph");

namespace simvis {
namespace {

const int kSequences = count_of("SIMVIS_TEST_SEQUENCES", sanitized() ? 500 : 2500);
constexpr int kSteps = 12;         // commands or changes of parameters in one sequence
constexpr double kFarthest = 100;  // parameters are drawn within this, and within their limits

class Sequence {
 public:
  Sequence(const std::filesystem::path& folder, std::uint32_t seed) : folder_(folder), random_(seed), scene_({}, {}) {}

  void run() {
    Flattener sensors(scene_.built.scene.root()), people(scene_.built.scene.root(), Audience::people);
    for (int step = 0; step < kSteps; ++step) {
      if (scene_.built.elements.empty() || pick(2) == 0) {
        execute();
      } else {
        change();
      }
      sensors.update();
      people.update();
    }
    const std::unique_ptr<LiveScene> fresh = rebuilt();
    Flattener sensors_afresh(fresh->built.scene.root()), people_afresh(fresh->built.scene.root(), Audience::people);
    CHECK(same_content(sensors.update(), sensors_afresh.update()));
    CHECK(same_content(people.update(), people_afresh.update()));
  }

  std::size_t items() { return Flattener(scene_.built.scene.root()).update().items.size(); }

 private:
  std::size_t pick(std::size_t count) { return std::uniform_int_distribution<std::size_t>(0, count - 1)(random_); }

  std::string some_point() {
    const std::vector<std::string> points = test::object_names(scene_.built.scene);
    return points[pick(points.size())];
  }

  // Elements that need only an insertion point, and those that name a part.
  std::string some_element() {
    static constexpr std::array kTypes = {"pose",
                                          "joint",
                                          "joint kind='prismatic'",
                                          "light",
                                          "light kind='point'",
                                          "light kind='spot'",
                                          "scale",
                                          "visibility",
                                          "sky",
                                          "material"};
    const std::string type = kTypes[pick(kTypes.size())];
    const std::vector<std::string> parts = test::part_names(scene_.built.scene);
    if (type != "material") return type;
    return parts.empty() ? "pose" : type + " part='" + parts[pick(parts.size())] + "'";
  }

  void execute() {
    const std::string name = "N" + std::to_string(commands_.size());
    std::string xml;
    switch (pick(3)) {
      case 0: {
        static constexpr std::array kFiles = {"a.stub", "b.stub", "arm.stub"};
        xml = "<part file='" + std::string(kFiles[pick(kFiles.size())]) + "' name='" + name + "' insert_at='" +
              some_point() + "'/>";
        break;
      }
      case 1: {
        std::string type = some_element();
        const std::size_t space = std::min(type.find(' '), type.size());
        xml = "<element type='" + type.substr(0, space) + "'" + type.substr(space) + " name='" + name +
              "' insert_at='" + some_point() + "'/>";
        break;
      }
      case 2:
        xml = "<sensor type='camera' name='" + name + "' insert_at='" + some_point() + "'/>";
        break;
    }
    commands_.push_back(xml);
    scene_.execute(parse_commands(xml, "s.xml", folder_));
  }

  void change() {
    Parameters& parameters = scene_.built.parameters;
    if (parameters.values().empty()) return;
    const std::size_t index = pick(parameters.values().size());
    const AttributeSpec& spec = parameters.spec(index);
    const double low = std::max(spec.min, -kFarthest), high = std::min(spec.max, kFarthest);
    double value = std::uniform_real_distribution<double>(low, high)(random_);
    if (spec.kind == AttributeKind::integer) value = std::floor(value);
    if (!check_number(spec, value).empty()) return;  // an open limit
    parameters.set(index, value);
    apply(scene_);
  }

  static void apply(LiveScene& scene) {
    Parameters& parameters = scene.built.parameters;
    for (const std::size_t i : parameters.drain_changed_elements()) {
      const ElementDescriptor& element = parameters.elements()[i];
      scene.built.elements[i]->update(parameters.values().subspan(element.first_value, element.parameters.size()));
    }
  }

  std::unique_ptr<LiveScene> rebuilt() const {
    auto fresh = std::make_unique<LiveScene>(std::vector<AttributeOverride>(), std::span<const Command>());
    for (const std::string& command : commands_) fresh->execute(parse_commands(command, "s.xml", folder_));
    const std::span<const double> values = scene_.built.parameters.values();
    REQUIRE(fresh->built.parameters.values().size() == values.size());
    for (std::size_t i = 0; i < values.size(); ++i) fresh->built.parameters.set(i, values[i]);
    apply(*fresh);
    return fresh;
  }

  std::filesystem::path folder_;
  std::mt19937 random_;
  LiveScene scene_;
  std::vector<std::string> commands_;
};

}  // namespace

TEST_CASE("what is flattened step by step equals what is flattened once") {
  const TemporaryFolder folder;
  write_text(folder / "a.stub", "triangle 1");
  write_text(folder / "b.stub", "triangle 2\npoint TOP");
  write_text(folder / "arm.stub", "triangle 3\npoint HAND\n<element type='joint' name='TILT' insert_at='HAND'/>");
  std::size_t items = 0;
  for (int i = 0; i < kSequences; ++i) {
    CAPTURE(i);
    Sequence sequence(folder.path(), static_cast<std::uint32_t>(i));
    sequence.run();
    items += sequence.items();
  }
  CHECK(items > kSequences);  // the scenes were not empty
}

}  // namespace simvis

TEST_SUITE_END();
