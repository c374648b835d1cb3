// The scene language: expressions, commands, whole scenes without a device, and the tables that go with scenes.
#include <memory>
#include <string>

#include <simvis/command.h>
#include <simvis/error.h>
#include <simvis/trajectory.h>
#include "elements/visualization/point_file.h"
#include "scenegraph/flattener.h"
#include "scenegraph/language/expression.h"
#include "simvis/live_scene.h"
#include "tests/fuzz/fuzz_target.h"

namespace simvis::fuzz {
namespace {

void read_expression(Input input) {
  const VariableValues variables = {{"a", 2}, {"b_1", -0.5}};
  double value = 0;
  evaluate(text_of(input), variables, value);
  std::string text(text_of(input));
  substitute(text, variables);
}

void read_commands_text(Input input) {
  for (const Command& command : parse_commands(text_of(input), "fuzz.xml", input_folder())) to_string(command);
}

void read_scene(Input input) {
  LiveScene scene({}, parse_commands(text_of(input), "fuzz.xml", input_folder()));
  Flattener flattener(scene.built.scene.root());
  flattener.update();
}

void read_trajectory(Input input) {
  static LiveScene scene({}, parse_commands(R"(<element type="pose" name="P" insert_at="ROOT"/>
      <element type="joint" name="J" insert_at="ROOT" lower="-90" upper="90"/>)",
                                            "fixed.xml", input_folder()));
  Parameters& parameters = scene.built.parameters;
  const Trajectory trajectory(input_file("t.csv", input), parameters);
  for (const double time_s : {-1.0, 0.0, 0.5, trajectory.end_s()}) trajectory.apply(time_s, parameters);
}

void read_points(Input input) { read_point_file(input_file("points.xyz", input)); }

const TargetRegistration kExpression("expression", read_expression);
const TargetRegistration kCommands("commands", read_commands_text);
const TargetRegistration kScene("scene", read_scene);
const TargetRegistration kTrajectory("trajectory", read_trajectory);
const TargetRegistration kPoints("points", read_points);

}  // namespace
}  // namespace simvis::fuzz
