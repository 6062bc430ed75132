#include "taut/contact/repulsion.h"

namespace taut {

ContactRow repulsion_row(const NearPair& near, double thickness, double friction) {
  ContactRow row;
  row.node = near.pair.node;
  row.weight = near.proximity.weight;
  row.normal = near.proximity.normal;
  row.target = near.proximity.distance + parting_share * (thickness - near.proximity.distance);
  row.friction = friction;
  return row;
}

}  // namespace taut
