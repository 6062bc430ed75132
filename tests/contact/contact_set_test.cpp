#include "taut/contact/contact_set.h"

#include "contact/point_masses.h"

namespace taut {
namespace {

using test::plane;
using test::sphere;
constexpr double h = 0.01, touch = 1e-6;

// Nodes over one step; all that moves them is the test.
struct Nodes {
  std::vector<Vec3> start, end;
  ConstraintSet pins;
  explicit Nodes(std::vector<Vec3> x) : start(x), end(std::move(x)), pins(count()) {}
  Index count() const { return static_cast<Index>(start.size()); }
  int begin(ContactSet& set, const ContactState& before = {}) const {
    const int added = set.begin_step(0.0, h, start, end, pins, before);
    set.renew_planes(end);
    return added;
  }
};

ContactSet set_of(std::vector<Solid> solids, Index nodes,
                  std::vector<std::vector<std::uint8_t>> meets = {}) {
  return ContactSet(SolidObstacles(std::move(solids), nodes, touch, std::move(meets)));
}

std::vector<std::pair<Index, Index>> pairs(const ContactSet& set) {
  std::vector<std::pair<Index, Index>> result;
  for (const Contact& contact : set.contacts()) result.emplace_back(contact.node, contact.solid);
  return result;
}

using Pairs = std::vector<std::pair<Index, Index>>;

TEST(ContactSet, findsNodesThatWouldEndInsideInOrder) {
  Nodes nodes({Vec3(0.1, 0, 0.1), Vec3(0.2, 0, 0.1), Vec3(0.1, 0, 0.1), Vec3(0.3, 0, 0.0)});
  nodes.end[0] = Vec3(-0.1, 0, -0.2);  // through both
  nodes.end[2] = Vec3(0.1, 0, -0.1);
  ContactSet set = set_of({plane(Vec3::UnitX()), plane(Vec3::UnitZ())}, nodes.count());
  EXPECT_EQ(nodes.begin(set), 4);
  EXPECT_EQ(pairs(set), (Pairs{{0, 0}, {0, 1}, {2, 1}, {3, 1}}));
  ASSERT_EQ(set.touched().size(), 3u);
  EXPECT_EQ(set.touched()[0].count, 2);
  EXPECT_EQ(set.touched()[2].first, 3);
}

TEST(ContactSet, planesSayWhereTheSolidIsAtTheEnd) {
  Solid floor = plane(Vec3::UnitZ(), 0.3);
  floor.thickness = 0.02;
  floor.velocity = Vec3(0.4, 0.0, 1.5);
  Nodes nodes({Vec3(0.1, 0, 0.025)});
  ContactSet set = set_of({floor}, 1);
  nodes.begin(set);
  ASSERT_EQ(set.contacts().size(), 1u);
  ConstraintSet constraints = nodes.pins;
  set.constrain(constraints);
  EXPECT_EQ(constraints.ndof(0), 2);
  const double height = 0.02 + 1.5 * h;
  EXPECT_LT((constraints.displacement(0) - (height - 0.025) * Vec3::UnitZ()).norm(), 1e-15);
}

TEST(ContactSet, stickingNodeEndsWhereItsSolidCarriesIt) {
  Solid floor = plane(Vec3::UnitZ(), 0.3);
  floor.velocity = Vec3(0.4, -0.2, 1.5);
  Nodes nodes({Vec3(0.1, 0, 0.0)});
  ContactSet set = set_of({floor}, 1);
  nodes.end[0] += h * floor.velocity;
  nodes.begin(set);
  TouchedNode& touched = set.touched()[0];
  touched.friction.begin(set.slips(touched, nodes.end[0]), h * floor.velocity.norm());
  ASSERT_TRUE(touched.friction.sticks());
  set.renew_planes(nodes.end);
  ConstraintSet constraints = nodes.pins;
  set.constrain(constraints);
  EXPECT_EQ(constraints.ndof(0), 0);
  EXPECT_LT((constraints.displacement(0) - h * floor.velocity).norm(), 1e-15);
}

// Its other contacts have the planes of where it ends, not of where the last pass took it.
TEST(ContactSet, otherPlanesOfStickingNodeAreThoseAtItsTarget) {
  Nodes nodes({Vec3::Zero()});
  ContactSet set = set_of({plane(Vec3::UnitZ(), 0.3), sphere(1.0, 0.0, Vec3::UnitX())}, 1);
  nodes.begin(set);
  ASSERT_EQ(pairs(set), (Pairs{{0, 0}, {0, 1}}));
  TouchedNode& touched = set.touched()[0];
  touched.friction.begin(set.slips(touched, nodes.end[0]), 0.0);
  ASSERT_TRUE(touched.friction.sticks());
  set.renew_planes(std::vector<Vec3>{Vec3(0.0, 0.1, 0.0)});
  EXPECT_LT((set.contacts()[1].normal + Vec3::UnitX()).norm(), 1e-15);
  EXPECT_NEAR(set.contacts()[1].distance, 0.0, 1e-15);
}

TEST(ContactSet, pinsAndForbiddenPairsKeepNodesOut) {
  Nodes nodes({Vec3::Zero(), Vec3::Zero(), Vec3::Zero()});
  for (Vec3& x : nodes.end) x.z() = -0.01;
  nodes.pins.fix(0, Vec3::Zero());
  ContactSet set = set_of({plane(Vec3::UnitZ()), plane(Vec3::UnitZ())}, 3, {{1, 0, 1}, {}});
  nodes.begin(set);
  EXPECT_EQ(pairs(set), (Pairs{{1, 1}, {2, 0}, {2, 1}}));
}

TEST(ContactSet, slipIsRelativeToTheSolidInFreeDirections) {
  Solid floor = plane(Vec3::UnitZ(), 0.25);
  floor.velocity = Vec3(0.4, 0.0, 0.0);
  Nodes nodes({Vec3::Zero(), Vec3::Zero()});
  nodes.pins.constrain(1, Vec3::UnitX(), 0.0);
  ContactSet set = set_of({floor}, 2);
  nodes.begin(set);
  set.split(set.touched()[0], Vec3(0, 0, 2.0), 0.0);
  const Vec3 end(0.01, 0.02, 0.03);
  const ContactSlip free = set.slips(set.touched()[0], end)[0];
  EXPECT_LT((free.slip - Vec3(0.01 - 0.4 * h, 0.02, 0.0)).norm(), 1e-15);
  EXPECT_DOUBLE_EQ(free.hold, 0.25 * 2.0);
  const ContactSlip on_a_line = set.slips(set.touched()[1], end)[0];
  EXPECT_LT((on_a_line.slip - Vec3(0.0, 0.02, 0.0)).norm(), 1e-15);
  EXPECT_EQ(on_a_line.hold, 0.0);
}

TEST(ContactSet, holderIsWhatCanHoldMost) {
  Nodes nodes({Vec3::Zero()});
  ContactSet set = set_of({plane(Vec3::UnitX(), 0.2), plane(Vec3::UnitZ(), 0.3)}, 1);
  nodes.begin(set);
  EXPECT_EQ(set.holder(set.touched()[0]), 1u);  // nothing pushes yet: the rougher one
  const ContactSet::Share share = set.split(set.touched()[0], Vec3(6.0, 5.0, 2.0), 0.0);
  EXPECT_FALSE(share.pulls);
  EXPECT_LT((share.tangential - Vec3(0, 5, 0)).norm(), 1e-15);
  EXPECT_EQ(set.holder(set.touched()[0]), 0u);
  EXPECT_DOUBLE_EQ(set.hold(set.touched()[0]), 0.2 * 6.0 + 0.3 * 2.0);
}

TEST(ContactSet, letsGoOfTheGreatestPullAndOfNoContactThrice) {
  Nodes nodes({Vec3::Zero()});
  ContactSet set = set_of({plane(Vec3::UnitX()), plane(Vec3::UnitZ())}, 1);
  nodes.begin(set);
  const std::vector<Vec3> under = {Vec3(0.0, 0.0, -0.1)};
  for (int k = 0; k < 2; ++k) {
    ASSERT_TRUE(set.split(set.touched()[0], Vec3(-1.0, 0.0, -2.0), 0.0).pulls);
    const ContactSet::Change dropped = set.drop_released();
    EXPECT_EQ(dropped.contacts, 1);
    EXPECT_TRUE(dropped.matters);
    ASSERT_EQ(pairs(set), (Pairs{{0, 0}}));
    const ContactSet::Change added = set.add_inside(under);
    EXPECT_EQ(added.contacts, 1);
    EXPECT_TRUE(added.matters);
    ASSERT_EQ(pairs(set), (Pairs{{0, 0}, {0, 1}}));
  }
  EXPECT_FALSE(set.split(set.touched()[0], Vec3(1.0, 0.0, -2.0), 0.0).pulls);
  EXPECT_EQ(set.drop_released().contacts, 0);
  // In the next step it may go again.
  nodes.begin(set);
  EXPECT_TRUE(set.split(set.touched()[0], Vec3(1.0, 0.0, -2.0), 0.0).pulls);
}

TEST(ContactSet, smallPullsGoButWaitForTheNextStep) {
  for (const double pull : {0.005, 0.02}) {
    Nodes nodes({Vec3::Zero(), Vec3::UnitX()});
    ContactSet set = set_of({plane(Vec3::UnitZ())}, 2);
    nodes.begin(set);
    set.split(set.touched()[0], Vec3::UnitZ(), 0.0);
    set.split(set.touched()[1], -pull * Vec3::UnitZ(), 0.0);
    const ContactSet::Change dropped = set.drop_released();
    EXPECT_EQ(dropped.contacts, 1);
    EXPECT_EQ(dropped.matters, pull > 0.01);
    EXPECT_EQ(pairs(set), (Pairs{{0, 0}}));
  }
}

TEST(ContactSet, shallowNodesComeInButWaitForTheNextStep) {
  for (const double depth : {1e-4, 1e-3}) {
    Nodes nodes({Vec3(0, 0, 1.1)});
    ContactSet set = set_of({sphere(1.0)}, 1);
    ASSERT_EQ(nodes.begin(set), 0);
    const ContactSet::Change added = set.add_inside(std::vector<Vec3>{Vec3(0, 0, 1.0 - depth)});
    EXPECT_EQ(added.contacts, 1);
    EXPECT_EQ(added.matters, depth > 2e-4);
  }
}

TEST(ContactSet, floatingNodeAsksForTwoPasses) {
  Nodes nodes({Vec3(0, 0, 1.0)});
  ContactSet set = set_of({sphere(1.0)}, 1);
  ASSERT_EQ(nodes.begin(set), 1);
  const std::vector<Vec3> along = {Vec3(0.1, 0, 1.0)};  // on the old plane, off the sphere
  for (const bool asks : {true, true, false}) {
    set.add_inside(along);
    set.renew_planes(along);
    EXPECT_EQ(set.ask_for_floating(), asks);
  }
  const Contact& contact = set.contacts()[0];
  EXPECT_LT((contact.normal - along[0].normalized()).norm(), 1e-15);
  EXPECT_NEAR(contact.normal.dot(nodes.start[0]) + contact.distance, 1.0, 1e-15);
}

TEST(ContactSet, contactsOfTheStepBeforeGoOnWhereTheyStillTouch) {
  Nodes nodes({Vec3::Zero(), Vec3::Zero(), Vec3(0, 0, 0.1)});
  for (Vec3& x : nodes.end) x.z() += 0.1;  // away: none would be found anew
  nodes.pins.fix(1, Vec3::Zero());
  const ContactStick stick{0, 2, 3};
  const ContactForce force{7.0, {1.0, 2.0, 0.0}, 4.0};
  const ContactState before{{0, 1, 2}, {0, 0, 0}, {stick, stick, stick}, {force, force, force}};
  ContactSet set = set_of({plane(Vec3::UnitZ(), 0.1)}, 3);
  EXPECT_EQ(nodes.begin(set, before), 0);
  ASSERT_EQ(pairs(set), (Pairs{{0, 0}}));
  EXPECT_DOUBLE_EQ(set.contacts()[0].lambda, h * 7.0);
  const StickSlip& friction = set.touched()[0].friction;
  EXPECT_EQ(friction.stick(), stick);
  EXPECT_LT((friction.impulse() - h * Vec3(1, 2, 0)).norm(), 1e-15);
}

}  // namespace
}  // namespace taut
