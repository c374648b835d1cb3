#include "import/urdf/urdf_sensors.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <iterator>
#include <memory>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include <simvis/attributes.h>
#include <simvis/error.h>
#include "engine/base/words.h"
#include "import/mesh/picture_file.h"
#include "import/model/unique_names.h"
#include "import/sdf/sdf_commands.h"
#include "import/sdf/sdf_messages.h"

namespace simvis {
namespace {

// Gazebo classic makes SDF 1.7 of a URDF file.
constexpr int kSdfVersion = 7;

struct SensorPlugin {
  std::string_view file;  // part of its name
  const char* type;
};
constexpr SensorPlugin kSensorPlugins[] = {{"hector_gazebo_ros_gps", "gnss"},
                                           {"hector_gazebo_ros_imu", "imu"},
                                           {"gazebo_ros_imu", "imu"},
                                           {"hector_gazebo_ros_magnetic", "magnetometer"}};

// Numbers of plug-ins that are attributes of their sensors.
struct Setting {
  std::string_view type;
  const char* tag;
  const char* attribute;
};
constexpr Setting kSettings[] = {{"gnss", "referenceLatitude", "latitude"},
                                 {"gnss", "referenceLongitude", "longitude"},
                                 {"gnss", "referenceAltitude", "elevation"},
                                 {"imu", "accelGaussianNoise", "accelerometer_stddev"},
                                 {"imu", "rateGaussianNoise", "gyroscope_stddev"}};
// Other elements that are read, of all types or of one, and those that say how Gazebo runs the plug-in.
struct ReadTag {
  std::string_view type, tag;
};
constexpr ReadTag kReadTags[] = {{"", "updateRate"},
                                 {"", "bodyName"},
                                 {"", "topicName"},
                                 {"", "robotNamespace"},
                                 {"", "frameId"},
                                 {"", "frameName"},
                                 {"", "alwaysOn"},
                                 {"", "serviceName"},
                                 {"gnss", "referenceHeading"},
                                 {"imu", "xyzOffset"},
                                 {"imu", "rpyOffset"},
                                 {"magnetometer", "referenceHeading"},
                                 {"magnetometer", "declination"},
                                 {"magnetometer", "inclination"},
                                 {"magnetometer", "magnitude"}};

std::set<std::string> links_of(const UrdfFile& file) {
  std::set<std::string> links;
  for (const UrdfLink& each : file.links) links.insert(each.name);
  return links;
}

class UrdfSensors {
 public:
  UrdfSensors(const std::shared_ptr<const UrdfSource>& source, const ImportRequest& request, ImportReport& report)
      : file_{source->file().text, PackageFiles(request.file, request.packages), kSdfVersion},
        links_(links_of(source->file())),
        messages_(links_),
        report_(report) {}

  std::vector<std::string> commands() {
    for (const pugi::xml_node node : file_.text->document().document_element().children("gazebo")) {
      const SdfElement block(node, file_);
      const std::string link = block.attribute("reference");
      for (const SdfElement& child : block.children()) {
        if (child.tag() == "sensor") try_to([&] { add_sensor(child, link); });
        if (child.tag() == "plugin") try_to([&] { add_plugin(child); });
      }
    }
    return std::move(commands_);
  }

 private:
  // An element that is wrong is left out with a warning.
  template <class Action>
  void try_to(const Action& action) {
    try {
      action();
    } catch (const InputError& error) {
      report_.warn(without_word_error(error.what()) + "; the sensor is left out");
    }
  }

  void require_link(const std::string& link, const SdfElement& where) const {
    if (links_.contains(link)) return;
    where.fail("is a sensor of the link " + in_quotes(link) + ", which is not there");
  }

  SdfPlace place_of(const std::string& name, const std::string& link) { return {names_.add(sensor_name(name)), link}; }

  void add_sensor(const SdfElement& sensor, const std::string& link) {
    require_link(link, sensor);
    const SdfPose pose = read_sdf_pose(sensor);
    if (!pose.relative_to.empty() && pose.relative_to != link) {
      sensor.fail("has a <pose> relative to " + in_quotes(pose.relative_to) + ", expected one relative to its link");
    }
    std::optional<std::string> command =
        sdf_sensor_command(sensor, {}, place_of(sensor.name(), link), pose.matrix, messages_, report_);
    if (command) commands_.push_back(std::move(*command));
  }

  void add_plugin(const SdfElement& plugin) {
    const std::string library = plugin.attribute("filename");
    const auto* const known = std::ranges::find_if(
        kSensorPlugins, [&](const SensorPlugin& each) { return library.find(each.file) != library.npos; });
    if (known == std::end(kSensorPlugins) || library.find("imu_sensor") != library.npos) return;  // no sensor
    const std::string link = plugin.child("bodyName").text();
    require_link(link, plugin);
    const SdfPlace place = place_of(plugin.name(), link);
    SdfCommand command(CommandKind::sensor, known->type, place);
    const double rate_hz = plugin.child("updateRate").number(0);
    if (rate_hz > 0) command.add("rate", rate_hz);
    add_settings(plugin, known->type, command);
    report_unread(plugin, known->type);
    messages_.add_plugin(plugin, place, command, report_);
    commands_.push_back(command.text());
  }

  // Those of hector_gazebo_plugins, whose heading is clockwise from north, and whose noise is that of each axis.
  static void add_settings(const SdfElement& plugin, std::string_view type, SdfCommand& command) {
    if (type == "gnss") command.add("heading", 90 - plugin.child("referenceHeading").number(0));
    if (type == "imu") {
      command.add("orientation", "on");
      for (const char* const tag : {"xyzOffset", "rpyOffset"}) {
        const SdfElement offset = plugin.child(tag);
        if (offset.vector(glm::dvec3(0)) != glm::dvec3(0)) offset.fail("moves the sensor, expected no offset");
      }
    }
    if (type == "magnetometer") add_field(plugin, command);
    for (const Setting& each : kSettings) {
      if (type != each.type) continue;
      const std::string written = plugin.child(each.tag).text();  // noise: one number, or one for each axis
      const std::vector<std::string_view> numbers = words_of(written);
      double value = 0;
      if (numbers.empty()) continue;
      if (!parse_number(numbers.front(), value)) {
        plugin.fail("has a <" + std::string(each.tag) + "> that is no number: " + in_quotes(written));
      }
      command.add(each.attribute, value);
    }
  }

  // As gazebo_ros_magnetic.cpp of hector_gazebo_plugins (3ce1c30) does: in axes of which x points to the heading, y a
  // quarter turn counter-clockwise of it. The inclination is positive downwards.
  static void add_field(const SdfElement& plugin, SdfCommand& command) {
    const auto radians = [&](const char* tag, double fallback) {
      return glm::radians(plugin.child(tag).number(fallback));
    };
    const double strength = plugin.child("magnitude").number(1), down = radians("inclination", 60);
    const double north = radians("referenceHeading", 0) - radians("declination", 0);
    command.add("field", strength * glm::dvec3(std::cos(down) * std::cos(north), std::cos(down) * std::sin(north),
                                               -std::sin(down)));
  }

  void report_unread(const SdfElement& plugin, std::string_view type) {
    for (const SdfElement& child : plugin.children()) {
      const auto is_it = [&](const ReadTag& each) {
        return child.tag() == each.tag && (each.type.empty() || each.type == type);
      };
      const auto is_setting = [&](const Setting& each) { return child.tag() == each.tag && each.type == type; };
      if (std::ranges::any_of(kReadTags, is_it) || std::ranges::any_of(kSettings, is_setting)) continue;
      report_.leave_out("element <" + std::string(child.tag()) + "> of a plug-in", child.at());
    }
  }

  SdfFile file_;
  std::set<std::string> links_;
  SdfMessages messages_;
  UniqueNames names_;
  ImportReport& report_;
  std::vector<std::string> commands_;
};

}  // namespace

std::vector<std::string> urdf_sensor_commands(const std::shared_ptr<const UrdfSource>& source,
                                              const ImportRequest& request, ImportReport& report) {
  return UrdfSensors(source, request, report).commands();
}

}  // namespace simvis
