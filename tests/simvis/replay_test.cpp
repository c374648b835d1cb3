// The log of changes makes the scene: a replay of it, from any moment on, has the draw list of the host.
#include <doctest/doctest.h>

#include <algorithm>
#include <random>

#include "scenegraph/flattener.h"
#include "simvis/live_scene.h"
#include "tests/support/long_count.h"
#include "tests/support/object_names.h"
#include "tests/support/parts/stub_part.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

/// Makes random commands. Some are refused: names are taken, missing, or referred to.
class RandomCommands {
 public:
  explicit RandomCommands(std::uint32_t seed) : random_(seed) {}

  std::string request(const BuiltScene& built) {
    points_ = test::object_names(built.scene);
    living_ = test::part_names(built.scene);
    for (const ElementDescriptor& element : built.parameters.elements()) {
      if (!element.removed) living_.push_back(element.name);
    }
    for (const BuiltSensor& sensor : built.sensors) living_.push_back(sensor.name);
    std::string xml;
    for (std::size_t i = 0, count = 1 + number(6) / 4; i < count; ++i) xml += command();
    return xml;
  }
  std::size_t number(std::size_t below) { return random_() % below; }

 private:
  std::string part() { return "P" + std::to_string(number(9)); }
  std::string element() { return "E" + std::to_string(number(9)); }
  std::string sensor() { return "S" + std::to_string(number(2)); }
  std::string point() {
    switch (number(4)) {
      case 0:
        return part();
      case 1:
        return points_[number(points_.size())];
      default:
        return "ROOT";
    }
  }
  std::string element_of(const std::string& type, const std::string& attributes) {
    return "<element type='" + type + "' name='" + element() + "' insert_at='" + point() + "' " + attributes + "/>";
  }
  std::string command() {
    const std::string at = " insert_at='" + point() + "'";
    switch (number(14)) {
      case 0:
      case 1:
        return "<part shape='box' size='1 2 " + std::to_string(1 + number(2)) + "' name='" + part() + "'" + at + "/>";
      case 2:
      case 3:
        return "<part file='arm.stub' name='" + part() + "'" + at + " pose_offset='1 0 0 0 0 30'/>";
      case 4:
        return element_of("pose", "x='" + std::to_string(number(5)) + "'");
      case 5:
        return element_of("joint", "value='10'");
      case 6:
        return element_of("mimic_joint", "leader='" + element() + "'");
      case 7:
        return element_of("material", "part='" + part() + "' red='0.5'");
      case 8:
        return element_of("light", "kind='point'");
      case 9:
        return element_of("color_temperature", "light='" + element() + "'");
      case 10:
        return element_of("laser_beams", "scanner='" + sensor() + "'");
      case 11:
        return "<sensor type='laser_scanner' name='" + sensor() + "'" + at + " look_at='" + part() + "'/>";
      default: {
        const bool lives = !living_.empty() && number(4) > 0;
        return "<remove name='" + (lives ? living_[number(living_.size())] : part()) + "'/>";
      }
    }
  }
  std::mt19937 random_;
  std::vector<std::string> points_, living_;  // names of what the scene has
};

struct World {
  explicit World(std::span<const Command> commands = {}) : scene({}, commands) {}
  void replay(std::span<const std::string> log) {
    std::vector<Command> commands;
    for (const std::string& entry : log) commands.push_back(parse_commands(entry, "log", "/").front());
    scene.execute(commands);
  }
  void update() {
    Parameters& parameters = scene.built.parameters;
    for (const std::size_t i : parameters.drain_changed_elements()) {
      const ElementDescriptor& element = parameters.elements()[i];
      scene.built.elements[i]->update(parameters.values().subspan(element.first_value, element.parameters.size()));
    }
  }
  void copy_values(const Parameters& from) {
    Parameters& own = scene.built.parameters;
    for (std::size_t i = 0; i < from.values().size(); ++i) {
      if (!from.is_removed(i)) own.set(i, from.values()[i]);
    }
    update();
  }
  std::uint64_t hash() { return content_hash(flattener.update()); }
  LiveScene scene;
  Flattener flattener{scene.built.scene.root(), Audience::people};
};

/// The log without what was removed, and without its removal.
std::vector<std::string> survivors(const std::vector<std::string>& log) {
  std::vector<Command> commands;
  for (const std::string& entry : log) {
    const Command command = parse_commands(entry, "log", "/").front();
    if (command.kind != CommandKind::remove) {
      commands.push_back(command);
      continue;
    }
    const auto is_it = [&](const Command& each) {
      return each.require("name").value == command.require("name").value &&
             to_string(each.kind) == command.require("kind").value;
    };
    commands.erase(std::ranges::find_if(commands, is_it));
  }
  std::vector<std::string> texts;
  for (const Command& command : commands) texts.push_back(to_string(command));
  return texts;
}

void copy_values_by_name(const Parameters& from, World& to) {
  Parameters& own = to.scene.built.parameters;
  for (std::size_t i = 0; i < from.values().size(); ++i) {
    if (from.is_removed(i)) continue;
    const std::string name = from.name(i);
    const std::size_t dot = name.rfind('.');
    own.set(own.index(name.substr(0, dot), name.substr(dot + 1)), from.values()[i]);
  }
  to.update();
}

}  // namespace

TEST_CASE("replay: host, a follower from the start, a late one and a scene built afresh are equal") {
  const TemporaryFolder folder;
  write_text(folder / "arm.stub", "triangle 2\npoint HAND\n<element type='joint' name='TILT' insert_at='HAND'/>");
  const auto sequences = static_cast<std::uint32_t>(count_of("SIMVIS_TEST_SEQUENCES", sanitized() ? 200 : 2500));
  std::size_t executed = 0, refused = 0, removed = 0;
  for (std::uint32_t seed = 0; seed < sequences; ++seed) {
    RandomCommands random(seed);
    World host, follower;
    const Parameters& parameters = host.scene.built.parameters;
    const std::vector<std::string>& log = parameters.changes();
    std::size_t followed = 0;
    for (int request = 0; request < 10; ++request) {
      const std::uint64_t before = host.hash();
      const std::size_t logged = log.size();
      try {
        host.scene.execute(parse_commands(random.request(host.scene.built), "request", folder.path()));
        ++executed;
      } catch (const InputError&) {
        ++refused;
        REQUIRE(host.hash() == before);
        REQUIRE(log.size() == logged);
      }
      if (!parameters.values().empty()) {
        const std::size_t i = random.number(parameters.values().size());
        const AttributeSpec& spec = parameters.spec(i);
        if (!parameters.is_removed(i)) host.scene.built.parameters.set(i, std::clamp(0.25, spec.min, spec.max));
        host.update();
      }
      if (random.number(2) == 0) continue;  // the follower takes several requests at once
      follower.replay(std::span(log).subspan(followed));
      followed = log.size();
      follower.copy_values(parameters);
      REQUIRE(follower.hash() == host.hash());
    }
    CAPTURE(seed);
    World late, fresh;
    late.replay(log);
    late.copy_values(parameters);
    REQUIRE(late.hash() == host.hash());
    REQUIRE(late.scene.built.parameters.changes() == log);
    fresh.replay(survivors(log));
    copy_values_by_name(parameters, fresh);
    REQUIRE(fresh.hash() == host.hash());
    for (const ElementDescriptor& element : parameters.elements()) removed += element.removed;
  }
  CHECK(executed > 2 * sequences);
  CHECK(refused > 2 * sequences);
  CHECK(removed > sequences / 4);
}

}  // namespace simvis

TEST_SUITE_END();
