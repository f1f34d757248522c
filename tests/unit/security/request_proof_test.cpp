#include "forcebound/security/request_proof.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "forcebound/security/handshake_datagram.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/unit/security/handshakes.hpp"

namespace forcebound::security {
namespace {

class RequestProof : public testing::Test {
 protected:
  [[nodiscard]] HandshakeRequest request() const {
    return {.topic = {.client = 7}, .cookie = Cookie{std::byte{3}}, .message = message_};
  }

  KeyPair client_ = key_pair_from(key_bytes(1));
  KeyPair server_ = key_pair_from(key_bytes(2));
  ProofKey proves_{client_, server_.public_key};
  ProofKey judges_{server_, client_.public_key};
  std::array<std::byte, 96> message_{std::byte{9}};
};

TEST_F(RequestProof, IsMadeByTheClientAndKnownByTheServer) {
  const RequestDigest digest = digest_of(request());
  EXPECT_TRUE(judges_.made(proves_.of(digest), digest));
  EXPECT_FALSE(judges_.made(Proof{}, digest));
}

TEST_F(RequestProof, IsOfThisClientThisServerAndThisSharedKeyAlone) {
  const RequestDigest digest = digest_of(request());
  const KeyPair other = key_pair_from(key_bytes(4));
  EXPECT_FALSE(judges_.made(ProofKey(other, server_.public_key).of(digest), digest));
  EXPECT_FALSE(judges_.made(ProofKey(client_, other.public_key).of(digest), digest));
  const ProofKey shared(secret_key(3));
  EXPECT_TRUE(ProofKey(secret_key(3)).made(shared.of(digest), digest));
  EXPECT_FALSE(ProofKey(secret_key(5)).made(shared.of(digest), digest));
}

TEST_F(RequestProof, IsOfTheWholeRequest) {
  const Proof proof = proves_.of(digest_of(request()));
  for (std::size_t bit = 0; bit < 8 * message_.size(); ++bit) {
    message_[bit / 8] ^= std::byte{1} << bit % 8;
    EXPECT_FALSE(judges_.made(proof, digest_of(request()))) << bit;
    message_[bit / 8] ^= std::byte{1} << bit % 8;
  }
  HandshakeRequest changed = request();
  for (std::size_t bit = 0; bit < 8 * changed.cookie.size(); ++bit) {
    changed.cookie[bit / 8] ^= std::byte{1} << bit % 8;
    EXPECT_FALSE(judges_.made(proof, digest_of(changed))) << "recorded under cookie bit " << bit;
    changed.cookie[bit / 8] ^= std::byte{1} << bit % 8;
  }
  changed.topic.client = 8;
  EXPECT_FALSE(judges_.made(proof, digest_of(changed)));
}

TEST_F(RequestProof, TravelsInTheRequest) {
  HandshakeRequest sent = request();
  const RequestDigest digest = digest_of(sent);
  sent.proofs = {.own = proves_.of(digest), .shared = ProofKey(secret_key(3)).of(digest)};
  std::array<std::byte, kRequestBytes> datagram{};
  ASSERT_GT(write(sent, datagram), 0U);
  const auto read = read_handshake(datagram);
  const auto& received = std::get<HandshakeRequest>(read);
  EXPECT_EQ(received.proofs.own, sent.proofs.own);
  EXPECT_EQ(received.proofs.shared, sent.proofs.shared);
  EXPECT_EQ(digest_of(received), digest);
}

TEST_F(RequestProof, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const test::AllocationGuard guard;
  const RequestDigest digest = digest_of(request());
  const bool made = judges_.made(proves_.of(digest), digest);
  EXPECT_EQ(guard.heap_operations(), 0U);
  EXPECT_TRUE(made);
}

}  // namespace
}  // namespace forcebound::security
