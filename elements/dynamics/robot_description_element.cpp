// The element `robot_description`: sends the URDF of its part, and the frames of all its links.
//
//   <element type="robot_description" name="DESCRIPTION" insert_at="ARM"/>
//
// Parameters  none. It moves and draws nothing.
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <simvis/element.h>
#include <simvis/node.h>
#include "elements/command_source.h"
#include "elements/described_robot.h"
#include "import/model/model_description.h"
#include "scenegraph/language/attribute_place.h"

namespace simvis {
namespace {

class RobotDescriptionElement : public Element, public DescribedRobot {
 public:
  /// Throws InputError: the insertion point is no part from a URDF file; the topic is no topic of ROS.
  explicit RobotDescriptionElement(const ElementContext& context);
  void update(ParameterView /*values*/) override {}

  const std::string& topic() const override { return topic_; }
  const Location& where() const override { return where_; }
  const std::string& urdf() const override { return urdf_; }
  const std::map<std::string, std::filesystem::path>& files() const override { return files_; }
  const std::vector<std::string>& points() const override { return points_; }

 private:
  Location where_;
  std::string topic_, urdf_;
  std::map<std::string, std::filesystem::path> files_;
  std::vector<std::string> points_;
};

constexpr std::string_view kDescriptionTopic = "/robot_description";

constexpr AttributeSpec kRobotDescriptionRows[] = {
    {.name = "topic",
     .kind = AttributeKind::text,
     .default_value = kDescriptionTopic,
     .text = "topic of the std_msgs/String, which late subscribers get too"},
};

const ElementRegistration kRobotDescriptionRegistration({
    .name = "robot_description",
    .summary = "Gives ROS the URDF of its part, and the frames of all its links.",
    .notes =
        "The text is that of the file, with xacro expanded. If the part's names have a prefix, so have the frames: "
        "it is the TF prefix of RViz.",
    .attributes = kRobotDescriptionRows,
    .create = create_element<RobotDescriptionElement>,
});

}  // namespace

RobotDescriptionElement::RobotDescriptionElement(const ElementContext& context)
    : where_(place_of(context.command, "topic")),
      topic_(context.command.find("topic") == nullptr ? std::string(kDescriptionTopic)
                                                      : command_topic(context, "topic", "robot_description").topic) {
  const CommandAttribute& part = context.command.require("insert_at");
  if (context.scene.has_part(part.value)) {
    const PartContent& content = context.scene.content_of(part.value);
    if (content.model != nullptr) {
      // Programs that show the robot get its meshes too, and no others than those that can be read.
      context.scene.read_shapes_of(part.value, "element " + in_quotes(context.command.require("name").value));
      urdf_ = content.model->urdf();
      files_ = content.model->visual_files();
    }
  }
  if (urdf_.empty()) {
    fail_at(part.where, "attribute \"insert_at\": " + in_quotes(part.value) +
                            " is not allowed, expected the name of a part from a URDF or xacro file");
  }
  const ObjectTree& objects = context.scene.objects();
  points_ = objects.names_in(*objects.find(part.value));
  const auto mark = std::make_shared<Group>();
  mark->name = context.command.require("name").value;
  context.scene.insert(context.command, mark);
}

}  // namespace simvis
