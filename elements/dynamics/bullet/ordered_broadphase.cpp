#include "elements/dynamics/bullet/ordered_broadphase.h"

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>

#include <algorithm>
#include <cstdint>
#include <new>
#include <vector>

#include "elements/dynamics/bullet/bullet_archive.h"

namespace simvis {
namespace {

// Inserts the next leaf anew, as Bullet does in each step, so that a tree stays balanced while boxes move.
void balance(btDbvt& tree, int passes) {
  constexpr unsigned kPathBits = 8 * sizeof(unsigned);
  for (; tree.m_root != nullptr && passes > 0; --passes) {
    btDbvtNode* node = tree.m_root;
    for (unsigned bit = 0; node->isinternal(); bit = (bit + 1) % kPathBits) {
      node = node->childs[(tree.m_opath >> bit) & 1];
    }
    tree.update(node);
    ++tree.m_opath;
  }
}

void leave_list(btDbvtProxy& proxy, btDbvtProxy*& first) {
  (proxy.links[0] != nullptr ? proxy.links[0]->links[1] : first) = proxy.links[1];
  if (proxy.links[1] != nullptr) proxy.links[1]->links[0] = proxy.links[0];
}

void enter_list(btDbvtProxy& proxy, btDbvtProxy*& first) {
  proxy.links[0] = nullptr;
  proxy.links[1] = first;
  if (first != nullptr) first->links[0] = &proxy;
  first = &proxy;
}

}  // namespace

void OrderedBroadphase::TreeNode::archive(StateArchive& state) {
  state(number);
  archive_finite(state, box);
}

// In the order of btDbvtBroadphase::collide().
void OrderedBroadphase::calculateOverlappingPairs(btDispatcher* dispatcher) {
  balance(m_sets[DYNAMIC_SET], 1 + m_sets[DYNAMIC_SET].m_leaves * m_dupdates / 100);
  if (m_fixedleft > 0) {
    const int count = 1 + m_sets[FIXED_SET].m_leaves * m_fupdates / 100;
    balance(m_sets[FIXED_SET], count);
    m_fixedleft = std::max(0, m_fixedleft - count);
  }
  settle();
  if (m_needcleanup) clean_up(*dispatcher);
  ++m_pid;
  m_newpairs = 1;
  m_needcleanup = false;
}

// What has not moved for some steps goes over to the tree of what stands.
void OrderedBroadphase::settle() {
  m_stageCurrent = (m_stageCurrent + 1) % STAGECOUNT;
  if (m_stageRoots[m_stageCurrent] == nullptr) return;
  for (btDbvtProxy *proxy = m_stageRoots[m_stageCurrent], *next = nullptr; proxy != nullptr; proxy = next) {
    next = proxy->links[1];
    leave_list(*proxy, m_stageRoots[proxy->stage]);
    enter_list(*proxy, m_stageRoots[STAGECOUNT]);
    m_sets[DYNAMIC_SET].remove(proxy->leaf);
    proxy->leaf = m_sets[FIXED_SET].insert(btDbvtVolume::FromMM(proxy->m_aabbMin, proxy->m_aabbMax), proxy);
    proxy->stage = STAGECOUNT;
  }
  m_fixedleft = m_sets[FIXED_SET].m_leaves;
  m_needcleanup = true;
}

// Some pairs in each step.
void OrderedBroadphase::clean_up(btDispatcher& dispatcher) {
  const btBroadphasePairArray& pairs = m_paircache->getOverlappingPairArray();
  if (pairs.size() == 0) return;
  int count = std::min(pairs.size(), std::max(m_newpairs, pairs.size() * m_cupdates / 100));
  for (int i = 0; i < count; ++i) {
    const btBroadphasePair& pair = pairs[(m_cid + i) % pairs.size()];
    auto *const a = static_cast<btDbvtProxy*>(pair.m_pProxy0), *const b = static_cast<btDbvtProxy*>(pair.m_pProxy1);
    if (Intersect(a->leaf->volume, b->leaf->volume)) continue;
    m_paircache->removeOverlappingPair(a, b, &dispatcher);
    --count;
    --i;
  }
  m_cid = pairs.size() > 0 ? (m_cid + count) % pairs.size() : 0;
}

void OrderedBroadphase::remove_pairs(btDispatcher& dispatcher) {
  const btBroadphasePairArray& pairs = m_paircache->getOverlappingPairArray();
  while (pairs.size() > 0) {
    const btBroadphasePair& last = pairs[pairs.size() - 1];
    m_paircache->removeOverlappingPair(last.m_pProxy0, last.m_pProxy1, &dispatcher);
  }
}

void OrderedBroadphase::archive(StateArchive& state, std::span<btCollisionObject* const> objects) {
  constexpr int kMaxCount = 1 << 30;
  std::vector<btDbvtProxy*> proxies;
  for (btCollisionObject* const object : objects) {
    proxies.push_back(static_cast<btDbvtProxy*>(object->getBroadphaseHandle()));
    archive_finite(state, proxies.back()->m_aabbMin);
    archive_finite(state, proxies.back()->m_aabbMax);
  }
  state(m_stageCurrent, m_newpairs, m_fixedleft, m_pid, m_cid, m_needcleanup);
  state.require(m_stageCurrent >= 0 && m_stageCurrent < STAGECOUNT);
  for (const int count : {m_newpairs, m_fixedleft, m_cid}) state.require(count >= 0 && count < kMaxCount);
  archive_lists(state, proxies);
  for (const int set : {DYNAMIC_SET, FIXED_SET}) archive_tree(state, set, proxies);
  state.require(static_cast<std::size_t>(m_sets[DYNAMIC_SET].m_leaves + m_sets[FIXED_SET].m_leaves) == proxies.size());
}

void OrderedBroadphase::archive_lists(StateArchive& state, std::span<btDbvtProxy* const> proxies) {
  std::vector<std::vector<std::uint32_t>> lists(STAGECOUNT + 1);
  for (int stage = 0; !state.is_reading() && stage <= STAGECOUNT; ++stage) {
    for (const btDbvtProxy* each = m_stageRoots[stage]; each != nullptr; each = each->links[1]) {
      lists[static_cast<std::size_t>(stage)].push_back(number_of(proxies, each));
    }
  }
  for (std::vector<std::uint32_t>& list : lists) state(list);
  if (!state.is_reading()) return;
  std::vector<bool> is_found(proxies.size());
  std::size_t count = 0;
  for (int stage = 0; stage <= STAGECOUNT; ++stage) {
    std::vector<std::uint32_t>& list = lists[static_cast<std::size_t>(stage)];
    m_stageRoots[stage] = nullptr;
    std::ranges::reverse(list);
    for (const std::uint32_t number : list) {
      state.require(number < proxies.size() && !is_found[number]);
      is_found[number] = true;
      proxies[number]->stage = stage;
      enter_list(*proxies[number], m_stageRoots[stage]);
      ++count;
    }
  }
  state.require(count == proxies.size());
}

// Nodes in front of their children; a node has its object's number, or kNoNumber if it has children.
void OrderedBroadphase::archive_tree(StateArchive& state, int set, std::span<btDbvtProxy* const> proxies) {
  btDbvt& tree = m_sets[set];
  std::vector<TreeNode> nodes;
  if (!state.is_reading()) {
    std::vector<const btDbvtNode*> open;
    if (tree.m_root != nullptr) open.push_back(tree.m_root);
    while (!open.empty()) {
      const btDbvtNode* const node = open.back();
      open.pop_back();
      nodes.push_back({node->isleaf() ? number_of(proxies, node->data) : kNoNumber, node->volume});
      if (node->isinternal()) open.insert(open.end(), {node->childs[1], node->childs[0]});
    }
  }
  state(nodes, tree.m_opath);
  if (state.is_reading()) make_tree(state, set, nodes, proxies);
}

void OrderedBroadphase::make_tree(StateArchive& state, int set, std::span<const TreeNode> nodes,
                                  std::span<btDbvtProxy* const> proxies) {
  const auto is_leaf = [](const TreeNode& node) { return node.number != kNoNumber; };
  std::vector<bool> is_found(proxies.size());
  std::size_t open = nodes.empty() ? 0 : 1;  // nodes that are still to come
  for (const TreeNode& node : nodes) {
    state.require(open > 0);
    is_leaf(node) ? --open : ++open;
    if (!is_leaf(node)) continue;
    state.require(node.number < proxies.size() && !is_found[node.number] &&
                  (proxies[node.number]->stage == STAGECOUNT) == (set == FIXED_SET));
    is_found[node.number] = true;
  }
  state.require(open == 0);
  btDbvt& tree = m_sets[set];
  const unsigned path = tree.m_opath;
  tree.clear();
  tree.m_opath = path;
  tree.m_leaves = 0;
  struct Slot {
    btDbvtNode* parent;
    int child;
  };
  std::vector<Slot> slots{{nullptr, 0}};
  for (const TreeNode& each : nodes) {
    const Slot slot = slots.back();
    slots.pop_back();
    auto* const node = new (btAlignedAlloc(sizeof(btDbvtNode), 16)) btDbvtNode();
    node->volume = each.box;
    node->parent = slot.parent;
    (slot.parent == nullptr ? tree.m_root : slot.parent->childs[slot.child]) = node;
    if (is_leaf(each)) {
      node->data = proxies[each.number];
      node->childs[1] = nullptr;
      proxies[each.number]->leaf = node;
      ++tree.m_leaves;
    } else {
      slots.insert(slots.end(), {{node, 1}, {node, 0}});
    }
  }
}

}  // namespace simvis
