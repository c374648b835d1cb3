// Imports URDF robots as parts: links become insertion points and visuals, joints become element commands.
#include <algorithm>
#include <functional>
#include <glm/glm.hpp>
#include <iterator>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/node.h>
#include <simvis/part_importer.h>
#include <simvis/pose.h>
#include "engine/base/input_file.h"
#include "engine/base/read_fence.h"
#include "import/mesh/picture_file.h"
#include "import/model/model_frames.h"
#include "import/model/package_files.h"
#include "import/urdf/urdf_dynamics.h"
#include "import/urdf/urdf_file.h"
#include "import/urdf/urdf_sensors.h"
#include "import/urdf/urdf_visuals.h"
#include "import/urdf/xacro.h"

namespace simvis {
namespace {

void check_origin(const UrdfElement& owner, const glm::dmat4& matrix) {
  const glm::dvec3 size = glm::abs(glm::dvec3(matrix[3]));
  if (std::max({size.x, size.y, size.z}) <= kMaxCoordinate_m) return;
  owner.fail("has an origin that is not allowed, expected coordinates of at most " + format_number(kMaxCoordinate_m) +
             " m either way");
}

// Makes the node of a visual, or null.
using VisualMaker = std::function<NodePtr(const UrdfLink& link, const UrdfVisual& visual)>;

// Each link is a frame within that of its parent link: { joint origin, insertion point, visuals, child links }.
ModelFrames frames_of(const UrdfFile& file, const VisualMaker& make_visual) {
  ModelFrames frames(file.name);
  std::vector<std::size_t> own;  // frames of links
  for (const UrdfLink& link : file.links) {
    ModelStep step{.point = link.name, .object = ObjectKind::link};
    std::size_t parent = 0;
    if (!own.empty()) {
      const UrdfJoint& joint = file.joints[own.size() - 1];
      check_origin(joint.element, joint.model.parent_from_joint);
      step.joint = joint.model;
      step.place = joint.model.parent_from_joint;
      parent = own[joint.model.parent];
    }
    own.push_back(frames.add({.name = link.name, .parent = parent, .steps = {std::move(step)}}));
    for (const UrdfVisual& visual : link.visuals) {
      check_origin(link.element, visual.shape.link_from_shape);
      if (NodePtr node = make_visual(link, visual)) frames.add_visual(own.back(), std::move(node));
    }
  }
  return frames;
}

// Programs of robots read a .urdf as it is and ignore elements that they do not know, such as those of xacro that an
// expansion has left. They cannot read the expressions ${...} of xacro.
bool is_urdf_besides(const std::filesystem::path& file, const XmlText& text) {
  return file.extension() != ".xacro" && text.source().text().find("${") == std::string::npos;
}

// Some editors and copying programs leave zero bytes behind the end of a file.
XmlText read_without_zeros(const std::filesystem::path& file, std::vector<std::string>& warnings) {
  const Bytes bytes = read_whole_file(file);
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::size_t zeros = text.size() - std::min(text.find_last_not_of('\0') + 1, text.size());
  text.remove_suffix(zeros);
  if (zeros > 0)
    warnings.push_back(file.string() + ": " + std::to_string(zeros) + " zero bytes at its end are left out");
  return XmlText(SourceText(text, file.string()));
}

}  // namespace

XmlText read_urdf_text(const ImportRequest& request, PackageFiles& packages, std::vector<std::string>& warnings) {
  XmlText text = read_without_zeros(request.file, warnings);
  if (is_xacro(request.file, text)) {
    try {
      return expand_xacro(request.file, request.xacro_arguments, packages);
    } catch (const InputError& error) {
      if (!is_urdf_besides(request.file, text) || !request.xacro_arguments.empty()) throw;
      warnings.push_back(without_word_error(error.what()) + "; its elements of xacro are ignored");
      return text;
    }
  }
  if (!request.xacro_arguments.empty()) {
    fail_at({.file = request.file.string()}, "attribute \"xacro_arguments\" is not allowed: the file is no xacro");
  }
  return text;
}

namespace {

// A visual that is made later, and the group that it belongs into. The link and the visual are those of the source.
struct PostponedVisual {
  GroupPtr group;
  const UrdfLink* link;
  const UrdfVisual* visual;
};

// Makes the visuals of a robot. The packages of its meshes are those of the request that has read it.
class RobotVisuals {
 public:
  RobotVisuals(const ImportRequest& request, std::shared_ptr<UrdfSource> source, PackageFiles& packages,
               ContentPool& pool)
      : source_(std::move(source)),
        visuals_(request, packages, source_->meshes(),
                 request.up_given && request.up == UpAxis::y ? MeshFileAxes::y_up : MeshFileAxes::as_written, pool) {}

  NodePtr make(const UrdfLink& link, const UrdfVisual& visual) { return visuals_.make(link, visual); }
  void look(const UrdfLink& link, const UrdfVisual& visual) { visuals_.look(link, visual); }
  void finish(std::vector<std::string>& warnings) {
    visuals_.require_half();
    source_->set_visual_files(visuals_.release_mesh_files());
    std::ranges::move(visuals_.release_warnings(), std::back_inserter(warnings));
  }

 private:
  std::shared_ptr<UrdfSource> source_;
  UrdfVisuals visuals_;
};

ShapeReader reader_of(const ImportRequest& request, std::shared_ptr<UrdfSource> source,
                      std::vector<PostponedVisual> postponed) {
  return [request, source = std::move(source), postponed = std::move(postponed)](ContentPool& pool,
                                                                                 std::vector<std::string>& warnings) {
    const ModelFence fence(request.file);
    PackageFiles packages(request.file, request.packages);
    RobotVisuals visuals(request, source, packages, pool);
    std::vector<ShapesOfGroup> shapes;
    for (const PostponedVisual& each : postponed) {
      if (NodePtr node = visuals.make(*each.link, *each.visual)) shapes.push_back({each.group, {std::move(node)}});
    }
    visuals.finish(warnings);
    return shapes;
  };
}

PartContent import_urdf(const ImportRequest& request, ContentPool& pool) {
  PackageFiles packages(request.file, request.packages);
  PartContent content;
  XmlText text = read_urdf_text(request, packages, content.warnings);
  const ModelFence fence(request.file);
  const auto source = std::make_shared<UrdfSource>(request, read_urdf(std::move(text)));
  const UrdfFile& file = source->file();
  RobotVisuals visuals(request, source, packages, pool);
  std::vector<PostponedVisual> postponed;
  const ModelFrames frames = frames_of(file, [&](const UrdfLink& link, const UrdfVisual& visual) -> NodePtr {
    if (!request.postpone_shapes) return visuals.make(link, visual);
    visuals.look(link, visual);
    postponed.push_back({std::make_shared<Group>(), &link, &visual});
    return postponed.back().group;
  });
  content.root = frames.nodes();
  content.commands = frames.joint_commands(content.warnings);
  ImportReport report;
  std::ranges::move(urdf_sensor_commands(source, request, report), std::back_inserter(content.commands));
  std::ranges::move(report.release(), std::back_inserter(content.warnings));
  std::ranges::copy(file.warnings, std::back_inserter(content.warnings));
  visuals.finish(content.warnings);
  content.model = source;
  if (!postponed.empty()) content.read_shapes = reader_of(request, source, std::move(postponed));
  return content;
}

const PartImporterRegistration urdf_registration({".urdf", ".xacro"}, import_urdf);

}  // namespace
}  // namespace simvis
