#include "forcebound/server/dynamics/bodies/phantom_contacts.hpp"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>

#include "forcebound/server/dynamics/bodies/mujoco.hpp"

namespace forcebound::server {
namespace {

using Pose = std::array<double, 7>;

/// A block and a lintel that lies on it with one end, in free space.
class BlockAndLintel {
 public:
  BlockAndLintel()
      : model_(compile_mjcf("<mujoco><worldbody>"
                            "<body name='block'><freejoint/><geom type='box' size='.015 .015 .02'/></body>"
                            "<body name='lintel'><freejoint/><geom type='box' size='.055 .015 .01'/></body>"
                            "</worldbody></mujoco>",
                            "test.xml")),
        data_(make_data(*model_)) {}

  void place(const Pose& block, const Pose& lintel) {
    std::ranges::copy(block, data_->qpos);
    std::ranges::copy(lintel, data_->qpos + 7);
    ASSERT_TRUE(find_contacts(*model_, *data_));
  }

  [[nodiscard]] double deepest_m() const {
    double deepest_m = 0;
    for (int i = 0; i < data_->ncon; ++i) deepest_m = std::max(deepest_m, -data_->contact[i].dist);
    return deepest_m;
  }
  [[nodiscard]] int contacts() const { return data_->ncon; }

 private:
  ModelPointer model_;
  DataPointer data_;
};

struct Found {
  Pose block;
  Pose lintel;
  double depth_m;  ///< how deep the lintel's lower face is within the block's upper one
};

// As they came about in a stack at rest under a light touch. MuJoCo by itself finds 110, 74 and 62 mm.
const std::array<Found, 3> kWithPhantom{
    Found{{0.03999799890406755, 6.4853718354118524e-08, -0.00014452738658565179, 0.99999999982904442,
           -4.7209824695664677e-06, -1.7240441064314447e-05, 4.7318819722745528e-06},
          {-6.7137037114432949e-06, -6.5860577468380127e-08, 0.029744674283152604, 0.99999998279878211,
           -3.1398117400317161e-06, -0.00018537406881059964, 5.3881240733372027e-06},
          1.1e-4},
    Found{{0.039994099304791052, -3.359273245422256e-07, -0.00010754988440928536, 0.99999999006476326,
           1.0553477712032826e-05, -0.00014053503716153325, -3.0001806209995138e-06},
          {-1.4061033818452961e-05, -5.0516437463214375e-07, 0.029807010174667109, 0.99999999309002063,
           2.784643869342264e-05, -0.00011389277601096221, -8.5422617621264573e-06},
          8e-5},
    Found{{0.040006709926766575, -4.115443449607324e-09, -0.00014719037930857848, 0.99999998260375755,
           4.9989086026858779e-08, 0.00018652742879019806, 2.5924045051747458e-08},
          {1.9836367853004731e-05, -1.1836491146544467e-08, 0.029681081580322219, 0.9999999482473142,
           2.595561092722124e-07, 0.00032172239729434541, -3.0672161848104722e-08},
          2.1e-4},
};

TEST(PhantomContacts, BoxesThatLieOnEachOtherTouchNoDeeperThanTheyOverlap) {
  BlockAndLintel boxes;
  for (const Found& found : kWithPhantom) {
    boxes.place(found.block, found.lintel);
    EXPECT_GE(boxes.contacts(), 4) << "the true ones stay";
    EXPECT_GT(boxes.deepest_m(), 0.5 * found.depth_m);
    EXPECT_LT(boxes.deepest_m(), found.depth_m);
  }
}

TEST(PhantomContacts, BoxesThatAreReallyDeepWithinEachOtherKeepTheirContacts) {
  BlockAndLintel boxes;
  boxes.place({0.04, 0, 0, 1, 0, 0, 0}, {0, 0, 0.025, 1, 0, 0, 0});
  EXPECT_GE(boxes.contacts(), 4);
  EXPECT_GT(boxes.deepest_m(), 0.002);
  EXPECT_LE(boxes.deepest_m(), 0.005 + 1e-9);
}

}  // namespace
}  // namespace forcebound::server
