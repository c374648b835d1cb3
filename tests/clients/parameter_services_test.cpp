// The services of a node's parameters, without a network: what is asked, what is answered, what is refused.
#include <doctest/doctest.h>

#include <cmath>

#include "exchange/messages/cdr.h"
#include "exchange/messages/types/node_types.h"
#include "simvis/scene_builder.h"
#include "simvis/sharing/parameter_services.h"
#include "tests/support/error_of.h"

TEST_SUITE_BEGIN("clients");

namespace simvis {
namespace {

struct ServedNode {
  BuiltScene scene = build_scene(parse_commands(R"(
      <element type="pose" name="MOVE" insert_at="ROOT" x="1.5"/>
      <element type="joint" name="ELBOW" insert_at="ROOT" lower="-30" upper="60"/>)",
                                                "s.xml", ""));
  ParameterNames names{};
  template <ros::Message Reply, ros::Message Request>
  Reply ask(const std::string& service, const Request& request) {
    for (const ParameterService& each : parameter_services()) {
      if (each.name != service) continue;
      const auto reply = ros::decode<Reply>(each.answer(scene.parameters, names, ros::encode(request)));
      CHECK(reply.header.client == request.header.client);
      CHECK(reply.header.sequence == request.header.sequence);
      return reply;
    }
    FAIL("there is no such service");
    return {};
  }
  double get(const std::string& name) const {
    ParameterNames all;
    all.follow(scene.parameters);
    return scene.parameters.values()[all.index(name)];
  }
};

ros::Parameter value_of(const std::string& name, double value, std::uint8_t type = 3) {
  ros::Parameter parameter;
  parameter.name = name;
  parameter.value.type = type;
  parameter.value.double_value = value;
  parameter.value.integer_value = static_cast<std::int64_t>(std::isfinite(value) ? value : 0);
  return parameter;
}

constexpr ros::RequestHeader kHeader{.client = 5, .sequence = 11};

TEST_CASE("parameters are listed, all of them or those of an element") {
  ServedNode node;
  const auto all = node.ask<ros::ListParametersReply>("list_parameters", ros::ListParametersRequest{kHeader, {}, 0});
  CHECK(all.names ==
        std::vector<std::string>{"MOVE.x", "MOVE.y", "MOVE.z", "MOVE.roll", "MOVE.pitch", "MOVE.yaw", "ELBOW.value"});
  CHECK(all.prefixes == std::vector<std::string>{"MOVE", "ELBOW"});
  const auto some =
      node.ask<ros::ListParametersReply>("list_parameters", ros::ListParametersRequest{kHeader, {"ELBOW"}, 0});
  CHECK(some.names == std::vector<std::string>{"ELBOW.value"});
}

TEST_CASE("a prefix lists what is below it, to the depth that is asked for") {
  ServedNode node{build_scene(parse_commands(R"(
      <element type="joint" name="ARM.ELBOW" insert_at="ROOT"/><element type="joint" name="ARM" insert_at="ROOT"/>
      <element type="joint" name="ARMED" insert_at="ROOT"/>)",
                                             "s.xml", ""))};
  const auto listed = [&](const std::vector<std::string>& prefixes, std::uint64_t depth) {
    return node.ask<ros::ListParametersReply>("list_parameters", ros::ListParametersRequest{kHeader, prefixes, depth})
        .names;
  };
  using Names = std::vector<std::string>;
  CHECK(listed({"ARM"}, 0) == Names{"ARM.ELBOW.value", "ARM.value"});
  CHECK(listed({"ARM"}, 1) == Names{"ARM.value"});
  CHECK(listed({"ARM"}, 2) == Names{"ARM.ELBOW.value", "ARM.value"});
  CHECK(listed({"ARM.ELBOW", "ARMED"}, 1) == Names{"ARM.ELBOW.value", "ARMED.value"});
  CHECK(listed({"ARMED.value"}, 1) == Names{"ARMED.value"});
  CHECK(listed({}, 1).empty());
  CHECK(listed({}, 2) == Names{"ARM.value", "ARMED.value"});
  CHECK(listed({}, 0).size() == 3);
}

TEST_CASE("only one unknown name of a request is compared with all others") {
  ServedNode node;
  const ros::SetParametersRequest request{kHeader, {value_of("MOVE.w", 1), value_of("MOVE.v", 1), value_of("x", 1)}};
  const auto results = node.ask<ros::SetParametersReply>("set_parameters", request).results;
  REQUIRE(results.size() == 3);
  CHECK(contains(results[0].reason, "expected one of: x, y, z"));
  CHECK(results[1].reason == "there is no parameter \"MOVE.v\"");
  CHECK(contains(results[2].reason, "expected ELEMENT.PARAM"));
}

TEST_CASE("values, types and limits are read; names that are not there have none") {
  ServedNode node;
  const ros::NamedParametersRequest request{kHeader, {"MOVE.x", "MOVE.w", "nonsense", "ELBOW.value"}};
  const auto values = node.ask<ros::GetParametersReply>("get_parameters", request).values;
  REQUIRE(values.size() == 4);
  CHECK(values[0].type == 3);
  CHECK(values[0].double_value == 1.5);
  CHECK(values[1].type == 0);
  CHECK(values[2].type == 0);
  CHECK(node.ask<ros::GetParameterTypesReply>("get_parameter_types", request).types ==
        std::vector<std::uint8_t>{3, 0, 0, 3});
  const auto described = node.ask<ros::DescribeParametersReply>("describe_parameters", request).descriptors;
  REQUIRE(described.size() == 4);
  CHECK(described[1].type == 0);
  REQUIRE(described[3].floating_point_range.size() == 1);
  CHECK(described[3].floating_point_range[0].from_value == -30);
  CHECK(described[3].floating_point_range[0].to_value == 60);
  CHECK(described[3].description.find("(deg)") != std::string::npos);
}

TEST_CASE("parameters are set one by one, or all or none") {
  ServedNode node;
  const ros::SetParametersRequest mixed{
      kHeader,
      {value_of("MOVE.x", 2), value_of("ELBOW.value", 61), value_of("MOVE.y", NAN), value_of("MOVE.z", 1, 4),
       value_of("MOVE.w", 1), value_of("ELBOW.value", 7, 2)}};
  const auto atomically = node.ask<ros::SetParametersAtomicallyReply>("set_parameters_atomically", mixed).result;
  CHECK_FALSE(atomically.successful);
  CHECK(contains(atomically.reason, "ELBOW.value: 61"));
  CHECK(node.get("MOVE.x") == 1.5);
  const auto results = node.ask<ros::SetParametersReply>("set_parameters", mixed).results;
  REQUIRE(results.size() == 6);
  CHECK(results[0].successful);
  CHECK(node.get("MOVE.x") == 2);
  CHECK(contains(results[1].reason, "61"));
  CHECK(contains(results[2].reason, "nan"));
  CHECK(contains(results[3].reason, "type 4"));
  CHECK(contains(results[4].reason, "expected one of: x, y, z"));
  CHECK(results[5].successful);
  CHECK(node.get("ELBOW.value") == 7);
}

TEST_CASE("names follow the scene: elements that come, go, and are refused") {
  ServedNode node;
  SceneBuilder builder(node.scene, {});
  const auto execute = [&](const std::string& xml) { builder.execute(parse_commands(xml, "s.xml", "")); };
  const auto types = [&] {
    const ros::NamedParametersRequest request{kHeader, {"MOVE.x", "NEW.value", "ELBOW.value"}};
    return node.ask<ros::GetParameterTypesReply>("get_parameter_types", request).types;
  };
  using Types = std::vector<std::uint8_t>;
  CHECK(types() == Types{3, 0, 3});
  execute(R"(<element type="joint" name="NEW" insert_at="ROOT"/>)");
  CHECK(types() == Types{3, 3, 3});
  std::string many;  // more than the list of elements has room for
  for (int i = 0; i < 100; ++i)
    many += R"(<element type="pose" name="M)" + std::to_string(i) + R"(" insert_at="ROOT"/>)";
  CHECK(contains(error_of([&] { execute(many + R"(<element type="joint" name="NEW" insert_at="ROOT"/>)"); }), "NEW"));
  CHECK(types() == Types{3, 3, 3});
  execute(R"(<remove name="NEW"/>)");
  CHECK(types() == Types{3, 0, 3});
}

TEST_CASE("bytes that are no request are refused") {
  ServedNode node;
  for (const ParameterService& service : parameter_services()) {
    CAPTURE(service.name);
    for (const std::string& bytes : {std::string(), std::string("\0\1\0\0", 4), std::string("\0\1\0\0\1\2\3", 7),
                                     std::string("\0\1\0\0", 4) + std::string(16, '\1') + "\xff\xff\xff\x7f"}) {
      CHECK(
          contains(error_of([&] { service.answer(node.scene.parameters, node.names, bytes); }), "rcl_interfaces/srv/"));
    }
  }
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
