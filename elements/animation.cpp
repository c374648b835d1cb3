#include "elements/animation.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>
#include "scenegraph/part_animation.h"

namespace simvis {
namespace {

// About thirty years. Near this limit a double still resolves a tenth of a microsecond.
constexpr double kMaxTime_s = 1e9;

constexpr AttributeSpec kAnimationAttributes[] = {
    {.name = "part", .kind = AttributeKind::part, .text = "required: the part that is animated"},
    {.name = "clip",
     .kind = AttributeKind::text,
     .text = "name of the animation in the file, or its number from 0; default: the first"},
    {.name = "repeat",
     .kind = AttributeKind::choice,
     .default_value = "loop",
     .text = "at the end: loop starts again, once stays at the last pose",
     .choices = "loop once"},
    {.name = "time",
     .kind = AttributeKind::number,
     .default_value = "0",
     .unit = "s",
     .text = "time since the start of the animation",
     .min = -kMaxTime_s,
     .max = kMaxTime_s,
     .live = true},
};

const ElementRegistration kAnimationRegistration({
    .name = "animation",
    .summary = "Plays a glTF animation of a part, skinned and morphed meshes included.",
    .notes = "Two animation elements may play clips of one part if the clips change different nodes and meshes.",
    .attributes = kAnimationAttributes,
    .create = create_element<AnimationElement>,
});

// A marker in an animated part that lists the nodes an animation element changes, so that another element can detect a
// conflict. It has the name of the element.
class PlayedMark : public Group {
 public:
  explicit PlayedMark(std::vector<const Node*> driven) : driven_(std::move(driven)) {}
  bool meets(const std::vector<const Node*>& others) const {
    return std::ranges::find_first_of(driven_, others) != driven_.end();
  }

 private:
  std::vector<const Node*> driven_;
};

std::size_t find_clip(const ElementContext& context, const std::string& part, const PartContent& content) {
  if (content.animations == nullptr || content.animations->clips.empty()) {
    fail_at(context.attributes.where("part"),
            "part " + in_quotes(part) + " has no animation (file " + in_quotes(content.file.string()) + ")");
  }
  const std::vector<AnimationClip>& clips = content.animations->clips;
  if (!context.attributes.is_set("clip")) return 0;
  const std::string& clip = context.attributes.text("clip");
  std::vector<std::string_view> names;
  for (std::size_t i = 0; i < clips.size(); ++i) {
    if (clips[i].name == clip) return i;
    if (!clips[i].name.empty()) names.push_back(clips[i].name);
  }
  for (std::size_t i = 0; i < clips.size(); ++i) {
    if (std::to_string(i) == clip) return i;
  }
  std::string known;
  for (const std::string_view name : names) known += in_quotes(name) + ", ";
  fail_at(context.attributes.where("clip"), "part " + in_quotes(part) + " has no animation " + in_quotes(clip) +
                                                suggestion(clip, names) + " (expected one of: " + known +
                                                "or a number from 0 to " + std::to_string(clips.size() - 1) + ")");
}

void claim(const ElementContext& context, const std::string& part, const OwnPart& own,
           std::vector<const Node*> driven) {
  const auto root = std::dynamic_pointer_cast<Group>(own.root);
  for (const NodePtr& child : root->children()) {
    const auto other = std::dynamic_pointer_cast<const PlayedMark>(child);
    if (other == nullptr || !other->meets(driven)) continue;
    fail_at(context.command.where, "the animation moves nodes or meshes that the element " + in_quotes(other->name) +
                                       " already moves in part " + in_quotes(part) +
                                       " (expected animations of different nodes and meshes)");
  }
  const auto mark = std::make_shared<PlayedMark>(std::move(driven));
  mark->name = context.command.require("name").value;
  context.scene.insert(context.command, mark);
  root->add(mark);
  context.scene.undo().add([root, mark] { root->remove(*mark); }, [root, mark] { root->add(mark); });
}

}  // namespace

AnimationElement::AnimationElement(const ElementContext& context)
    : loops_(context.attributes.choice("repeat") == "loop") {
  const CommandAttribute& part = context.command.require("part");
  const OwnPart own = context.scene.own_part(part.value, part.where);
  const std::size_t clip = find_clip(context, part.value, own.content);
  player_ = std::make_shared<PartPlayer>(own.content.animations, clip, own.clone_of);
  claim(context, part.value, own, player_->driven());
  context.scene.undo().add([player = player_] { player->show_rest(); });
}

void AnimationElement::update(ParameterView values) {
  double time_s = values[0];
  const double duration_s = player_->duration_s();
  if (loops_ && duration_s > 0) {
    time_s = std::fmod(time_s, duration_s);  // exact
    if (time_s < 0) time_s += duration_s;
  }
  player_->show(time_s);
}

}  // namespace simvis
