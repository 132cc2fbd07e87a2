// The tree of cases of a certificate: cells whose sign is fixed, and what follows for the others.
#include "emax/base/elementary.hpp"
#include "emax/bound/energy_certificate.hpp"

#include "certificate_vectors.hpp"

namespace emax {
namespace {

constexpr std::size_t kLeafSweeps = 400;

}  // namespace

double* EnergyCertificate::vectors_of(std::size_t leaf) noexcept {
  return leaf_vectors_ + leaf * kRank * grid_.cells;
}

const double* EnergyCertificate::vectors_of(std::size_t leaf) const noexcept {
  return leaf_vectors_ + leaf * kRank * grid_.cells;
}

// Whatever follows from the fixed signs and the least length of runs, until nothing new does.
bool EnergyCertificate::propagate(std::int8_t* signs) const noexcept {
  bool changed = true;
  while (changed) {
    changed = false;
    for (std::size_t i = 0; i + 2 < grid_.cells; ++i) {
      for (std::size_t k = i + 2; k < grid_.cells && grid_.run_end[i + 1] > k; ++k) {
        for (std::size_t j = i + 1; j < k && grid_.run_end[j] > k; ++j) {
          // v_j alone against v_i and v_k is excluded.
          const std::int8_t first = signs[i];
          const std::int8_t middle = signs[j];
          const std::int8_t last = signs[k];
          if (first != 0 && first == last && middle != first) {
            if (middle != 0) {
              return false;
            }
            signs[j] = signs[i];
            changed = true;
          } else if (first != 0 && middle == -first && last == 0) {
            signs[k] = signs[j];
            changed = true;
          } else if (last != 0 && middle == -last && first == 0) {
            signs[i] = signs[j];
            changed = true;
          }
        }
      }
    }
  }
  return true;
}

// The cells with a sign become one, the first, and the others follow.
std::size_t EnergyCertificate::merge(const std::int8_t* signs) noexcept {
  const std::size_t cells = grid_.cells;
  std::size_t size = 1;
  for (std::size_t i = 0; i < cells; ++i) {
    size += signs[i] == 0 ? 1u : 0u;
  }
  double* const sums = merged_;
  for (std::size_t f = 0; f < size; ++f) {
    sums[f] = 0.0;
  }
  std::size_t row = 0;
  for (std::size_t i = 0; i < cells; ++i) {
    const double* const from = matrix_ + i * cells;
    if (signs[i] == 0) {
      double* const to = merged_ + ++row * size;
      std::size_t column = 0;
      for (std::size_t j = 0; j < cells; ++j) {
        if (signs[j] == 0) {
          to[++column] = from[j];
        }
      }
      continue;
    }
    std::size_t column = 0;
    for (std::size_t j = 0; j < cells; ++j) {
      if (signs[j] == 0) {
        sums[++column] += signs[i] * from[j];
      } else {
        sums[0] += signs[i] * signs[j] * from[j];
      }
    }
  }
  for (std::size_t f = 1; f < size; ++f) {
    merged_[f * size] = sums[f];
  }
  return size;
}

// A case with signs already set and propagated, vectors from those of a wider one.
bool EnergyCertificate::solve_leaf(std::size_t leaf, const std::int8_t* parent_signs,
                                   const double* parent_vectors) noexcept {
  const std::size_t cells = grid_.cells;
  const std::int8_t* const signs = signs_of(leaf);
  const std::size_t size = merge(signs);
  leaves_[leaf].size = static_cast<std::uint16_t>(size);
  const Span<std::int32_t> duals = memory_.duals.from(leaf * cells).first(cells);
  if (size == 1) {
    // A single pattern: its own value, whatever the multipliers say.
    double value = rounding_constant_ / scale_ - constant_;
    for (std::size_t i = 0; i < cells; ++i) {
      for (std::size_t j = 0; j < cells; ++j) {
        value += signs[i] * signs[j] * phi_[i * cells + j];
      }
    }
    duals[0] = static_cast<std::int32_t>(floor(value * kUnitsPerOne + 2.0));
    leaves_[leaf].bound = static_cast<double>(duals[0]) / kUnitsPerOne;
    return true;
  }
  double* const own = vectors_of(leaf);
  std::size_t parent_row = 0;
  std::size_t row = 0;
  for (std::size_t r = 0; r < kRank; ++r) {
    own[r] = parent_vectors[r];
  }
  for (std::size_t i = 0; i < cells; ++i) {
    parent_row += parent_signs[i] == 0 ? 1u : 0u;
    if (signs[i] == 0) {
      ++row;
      for (std::size_t r = 0; r < kRank; ++r) {
        own[row * kRank + r] = parent_vectors[parent_row * kRank + r];
      }
    }
  }
  return find_duals(merged_, size, own, kLeafSweeps, duals, leaves_[leaf].bound);
}

// What proves a case proves every part of it: the y of cells that become one add up.
void EnergyCertificate::take_over_duals(std::size_t parent, std::size_t leaf) noexcept {
  const std::size_t cells = grid_.cells;
  const std::int32_t* const from = memory_.duals.data() + parent * cells;
  std::int32_t* const to = memory_.duals.data() + leaf * cells;
  to[0] = from[0];
  std::size_t parent_row = 0;
  std::size_t row = 0;
  for (std::size_t i = 0; i < cells; ++i) {
    if (signs_of(parent)[i] != 0) {
      continue;
    }
    ++parent_row;
    if (signs_of(leaf)[i] == 0) {
      to[++row] = from[parent_row];
    } else {
      to[0] += from[parent_row];
    }
  }
  leaves_[leaf].bound = leaves_[parent].bound;
}

// The free cell that leans least to either sign.
std::size_t EnergyCertificate::undecided_cell(std::size_t leaf) const noexcept {
  const double* const vectors = vectors_of(leaf);
  const std::int8_t* const signs = signs_of(leaf);
  double least = 2.0;
  std::size_t found = grid_.cells;
  std::size_t row = 0;
  for (std::size_t i = 0; i < grid_.cells; ++i) {
    if (signs[i] != 0) {
      continue;
    }
    ++row;
    const double lean = abs(dot(vectors, vectors + row * kRank));
    if (lean < least) {
      least = lean;
      found = i;
    }
  }
  return found;
}

bool EnergyCertificate::branch() noexcept {
  const std::size_t cells = grid_.cells;
  if (!proven_ || leaf_count_ + 2 > max_leaves_ || node_count_ + 2 > memory_.nodes.size()) {
    return false;
  }
  std::size_t parent = 0;
  for (std::size_t node = 0; node < node_count_; ++node) {
    const CertificateNode& candidate = memory_.nodes[node];
    const CertificateNode& best = memory_.nodes[parent];
    if (candidate.kind == CertificateNode::Kind::kLeaf &&
        (best.kind != CertificateNode::Kind::kLeaf ||
         leaves_[candidate.leaf].bound > leaves_[best.leaf].bound)) {
      parent = node;
    }
  }
  const std::size_t leaf = memory_.nodes[parent].leaf;
  const std::size_t cell = undecided_cell(leaf);
  if (cell == cells) {
    return false;
  }
  CertificateNode children[2];
  for (std::size_t side = 0; side < 2; ++side) {
    const std::size_t spare = leaf_count_ + side;
    std::int8_t* const signs = signs_of(spare);
    for (std::size_t i = 0; i < cells; ++i) {
      signs[i] = signs_of(leaf)[i];
    }
    signs[cell] = static_cast<std::int8_t>(side == 0 ? 1 : -1);
    children[side].leaf = static_cast<std::uint32_t>(spare);
    if (!propagate(signs)) {
      children[side].kind = CertificateNode::Kind::kEmpty;
    } else if (!solve_leaf(spare, signs_of(leaf), vectors_of(leaf)) ||
               leaves_[spare].bound > leaves_[leaf].bound) {
      take_over_duals(leaf, spare);
    }
  }
  keep_children(parent, cell, children);
  return true;
}

// The first case with a y takes the place of its parent's, the second the next one that is free.
void EnergyCertificate::keep_children(std::size_t parent, std::size_t cell,
                                      CertificateNode* children) noexcept {
  const std::size_t places[2] = {memory_.nodes[parent].leaf, leaf_count_};
  std::size_t used = 0;
  for (std::size_t side = 0; side < 2; ++side) {
    CertificateNode& child = children[side];
    if (child.kind == CertificateNode::Kind::kLeaf) {
      move_leaf(child.leaf, places[used]);
      child.leaf = static_cast<std::uint32_t>(places[used]);
      ++used;
    }
    memory_.nodes[node_count_ + side] = child;
  }
  CertificateNode& split = memory_.nodes[parent];
  split.kind = CertificateNode::Kind::kSplit;
  split.cell = static_cast<std::uint16_t>(cell);
  split.children[0] = static_cast<std::uint32_t>(node_count_);
  split.children[1] = static_cast<std::uint32_t>(node_count_ + 1);
  if (used == 0) {
    leaves_[places[0]].bound = 0.0;
  }
  node_count_ += 2;
  leaf_count_ += used == 2 ? 1u : 0u;
}

void EnergyCertificate::move_leaf(std::size_t from, std::size_t to) noexcept {
  if (from == to) {
    return;
  }
  const std::size_t cells = grid_.cells;
  leaves_[to] = leaves_[from];
  for (std::size_t i = 0; i < kRank * cells; ++i) {
    vectors_of(to)[i] = vectors_of(from)[i];
  }
  for (std::size_t i = 0; i < cells; ++i) {
    signs_of(to)[i] = signs_of(from)[i];
    memory_.duals[to * cells + i] = memory_.duals[from * cells + i];
  }
}

}  // namespace emax
