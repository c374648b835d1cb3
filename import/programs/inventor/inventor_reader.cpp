// Reads Inventor and VRML files with Coin as imported scenes.
#include <Inventor/SoDB.h>
#include <Inventor/SoInput.h>
#include <Inventor/SoInteraction.h>
#include <Inventor/VRMLnodes/SoVRMLImageTexture.h>
#include <Inventor/VRMLnodes/SoVRMLInline.h>
#include <Inventor/VRMLnodes/SoVRMLWorldInfo.h>
#include <Inventor/actions/SoCallbackAction.h>
#include <Inventor/errors/SoDebugError.h>
#include <Inventor/errors/SoMemoryError.h>
#include <Inventor/errors/SoReadError.h>
#include <Inventor/fields/SoSFTime.h>
#include <Inventor/nodekits/SoNodeKit.h>
#include <Inventor/nodes/SoIndexedNurbsCurve.h>
#include <Inventor/nodes/SoIndexedNurbsSurface.h>
#include <Inventor/nodes/SoInfo.h>
#include <Inventor/nodes/SoNurbsCurve.h>
#include <Inventor/nodes/SoNurbsSurface.h>
#include <Inventor/nodes/SoSeparator.h>
#include <Inventor/nodes/SoText2.h>
#include <Inventor/nodes/SoWWWInline.h>

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <simvis/error.h>
#include "import/programs/inventor/checked_fopen.h"
#include "import/programs/inventor/inventor_lights.h"
#include "import/programs/inventor/inventor_pictures.h"
#include "import/programs/inventor/inventor_shapes.h"
#include "import/programs/inventor/vrml_files.h"
#include "import/programs/part_reader.h"

namespace simvis {
namespace {

void report(void* answer, AnswerKind kind, const std::string& text) {
  static_cast<AnswerWriter*>(answer)->add(kind, text);
}

void hear_error(const SoError* error, void* answer) {
  report(answer, AnswerKind::error, error->getDebugString().getString());
}

struct Listeners {
  AnswerWriter& answer;
  InventorPictures& pictures;
  const VrmlFiles& files;
};

// Coin continues without a texture that cannot be read, so this error becomes a warning.
void hear_read_error(const SoError* error, void* listeners) {
  const Listeners& heard = *static_cast<Listeners*>(listeners);
  if (heard.files.has_fault()) return;  // the fault says what is wrong: Coin was given no file
  const std::string text = error->getDebugString().getString();
  if (text.find("Could not read texture file") != std::string::npos) return heard.pictures.hear(text);
  heard.answer.add(AnswerKind::error, text);
}

void hear_debug_error(const SoError* error, void* answer) {
  const auto severity = static_cast<const SoDebugError*>(error)->getSeverity();
  if (severity != SoDebugError::INFO) report(answer, AnswerKind::warning, error->getDebugString().getString());
}

void start_coin(Listeners& listeners) {
  // Coin draws text with its built-in font: the fonts of the machine must not change the triangles of a part.
  ::setenv("COIN_FORCE_FREETYPE_OFF", "1", 1);
  SoDB::init();
  SoNodeKit::init();
  SoInteraction::init();
  SoError::setHandlerCallback(hear_error, &listeners.answer);
  SoReadError::setHandlerCallback(hear_read_error, &listeners);
  SoMemoryError::setHandlerCallback(hear_error, &listeners.answer);
  SoDebugError::setHandlerCallback(hear_debug_error, &listeners.answer);
  listeners.pictures.attach();
  SoVRMLImageTexture::setDelayFetchURL(FALSE);
  // With these settings both nodes read files from disk. SoWWWInline ignores its name unless a callback is set,
  // although the callback is never called.
  SoVRMLInline::setReadAsSoFile(TRUE);
  SoWWWInline::setReadAsSoFile(TRUE);
  SoWWWInline::setFetchURLCallBack([](const SbString&, void*, SoWWWInline*) {}, nullptr);
  // Clocks are stopped, so that a file gives the same scene at any time.
  SoDB::enableRealTimeSensor(FALSE);
  static_cast<SoSFTime*>(SoDB::getGlobalField("realTime"))->setValue(SbTime::zero());
}

// One traversal of the graph.
class Collector {
 public:
  Collector() : shapes_(scene_) {}

  ImportedScene collect(SoNode& root) {
    SoCallbackAction action;
    action.addPreCallback(SoShape::getClassTypeId(), begin_shape, this);
    action.addPostCallback(SoShape::getClassTypeId(), end_shape, this);
    action.addTriangleCallback(SoShape::getClassTypeId(), add_triangle, this);
    action.addLineSegmentCallback(SoShape::getClassTypeId(), add_line, this);
    action.addPointCallback(SoShape::getClassTypeId(), add_point, this);
    action.addPreCallback(SoLight::getClassTypeId(), add_light<SoLight>, this);
    action.addPreCallback(SoVRMLLight::getClassTypeId(), add_light<SoVRMLLight>, this);
    action.addPreCallback(SoInfo::getClassTypeId(), add_info, this);
    action.addPreCallback(SoVRMLWorldInfo::getClassTypeId(), add_world_info, this);
    action.apply(&root);
    if (shapes_.has_too_many()) {
      throw InputError("the file gives more than " + std::to_string(InventorShapes::kMaxCorners / 3) + " triangles");
    }
    if (!shapes_.fault().empty()) throw InputError(shapes_.fault());
    // Lights come before shapes, as in the draw list.
    std::stable_partition(scene_.nodes.begin(), scene_.nodes.end(),
                          [](const ImportedNode& node) { return node.light.has_value(); });
    return std::move(scene_);
  }

 private:
  using Action = SoCallbackAction;
  using Vertex = SoPrimitiveVertex;

  static Collector& of(void* self) { return *static_cast<Collector*>(self); }

  static Action::Response begin_shape(void* self, Action* action, const SoNode* node) {
    if (is_nurbs(*node)) {
      of(self).warn("NURBS curves and surfaces are left out");
      return Action::PRUNE;
    }
    if (node->isOfType(SoText2::getClassTypeId())) of(self).warn("screen-aligned text (Text2) is left out");
    InventorShapes& shapes = of(self).shapes_;
    shapes.begin(*action, *static_cast<const SoShape*>(node));
    return shapes.has_too_many() || !shapes.fault().empty() ? Action::ABORT : Action::CONTINUE;
  }
  static Action::Response end_shape(void* self, Action* action, const SoNode*) {
    of(self).shapes_.end(*action);
    return Action::CONTINUE;
  }
  static void add_triangle(void* self, Action* action, const Vertex* a, const Vertex* b, const Vertex* c) {
    of(self).shapes_.triangle(*action, {a, b, c});
  }
  static void add_line(void* self, Action* action, const Vertex* a, const Vertex* b) {
    of(self).shapes_.line(*action, {a, b});
  }
  static void add_point(void* self, Action* action, const Vertex* vertex) { of(self).shapes_.point(*action, *vertex); }
  template <class AnyLight>
  static Action::Response add_light(void* self, Action* action, const SoNode* node) {
    add_inventor_light(*action, *static_cast<const AnyLight*>(node), of(self).scene_);
    return Action::CONTINUE;
  }
  static Action::Response add_info(void* self, Action*, const SoNode* node) {
    const SoSFString& text = static_cast<const SoInfo*>(node)->string;
    // The default string of a node also begins with '<'.
    if (!text.isDefault()) of(self).add_commands(*node, {text.getValue().getString()});
    return Action::CONTINUE;
  }
  static Action::Response add_world_info(void* self, Action*, const SoNode* node) {
    const SoMFString& info = static_cast<const SoVRMLWorldInfo*>(node)->info;
    std::vector<std::string> texts;
    texts.reserve(static_cast<std::size_t>(info.getNum()));
    for (int i = 0; i < info.getNum(); ++i) texts.emplace_back(info[i].getString());
    of(self).add_commands(*node, texts);
    return Action::CONTINUE;
  }
  // Coin 4.0 needs a display of X11 to cut NURBS into triangles, and crashes without one.
  static bool is_nurbs(const SoNode& node) {
    return node.isOfType(SoNurbsSurface::getClassTypeId()) || node.isOfType(SoIndexedNurbsSurface::getClassTypeId()) ||
           node.isOfType(SoNurbsCurve::getClassTypeId()) || node.isOfType(SoIndexedNurbsCurve::getClassTypeId());
  }
  void warn(const std::string& what) {
    if (std::ranges::find(scene_.warnings, what) == scene_.warnings.end()) scene_.warnings.push_back(what);
  }
  // A node that occurs in several places adds its commands once.
  void add_commands(const SoNode& node, const std::vector<std::string>& texts) {
    if (!heard_.insert(&node).second) return;
    for (const std::string& text : texts) {
      const std::size_t start = text.find_first_not_of(" \t\r\n");
      if (start != std::string::npos && text[start] == '<') scene_.commands.push_back(text);
    }
  }

  ImportedScene scene_;
  InventorShapes shapes_;
  std::set<const SoNode*> heard_;
};

template <class Check>
ImportedScene read_with_coin(const ReadRequest& request, InventorPictures& pictures, const Check& check) {
  SoInput input;
  if (!input.openFile(std::filesystem::absolute(request.file).c_str())) throw InputError("Coin cannot open the file");
  SoSeparator* const root = SoDB::readAll(&input);
  check();
  if (root == nullptr) throw InputError("Coin cannot read the file");
  root->ref();
  pictures.find_missing(*root, request.file);
  ImportedScene scene = Collector().collect(*root);
  std::ranges::move(pictures.release_warnings(), std::back_inserter(scene.warnings));
  return scene;
}

}  // namespace

// Coin loads libraries for fonts where a file has text, and these look for fonts.
constexpr std::string_view kFoldersOfCoin[] = {"/usr/lib", "/usr/share", "/usr/local/share",      "/lib",
                                               "/lib64",   "/etc/fonts", "/var/cache/fontconfig", "/etc/ld.so.cache"};
const std::span<const std::string_view> kFoldersOfReader = kFoldersOfCoin;
const HelperProgram kProgramOfReader = HelperProgram::inventor;

ImportedScene read_part(const ReadRequest& request, AnswerWriter& answer) {
  InventorPictures pictures;
  VrmlFiles files(request.file);
  Listeners listeners{answer, pictures, files};
  start_coin(listeners);
  open_files_by(files);
  // Coin takes a fault of the machine for a broken file, or goes on without it.
  const auto rethrow_faults = [&] {
    rethrow_read_fault();
    pictures.rethrow_fault();
    files.rethrow_fault();
  };
  try {
    ImportedScene scene = read_with_coin(request, pictures, rethrow_faults);
    std::ranges::move(files.release_warnings(), std::back_inserter(scene.warnings));
    rethrow_faults();
    return scene;
  } catch (const InputError&) {
    rethrow_faults();
    throw;
  }
}

}  // namespace simvis
