#include "forcebound/server/security/request_judge.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "forcebound/server/session/source_buckets.hpp"

namespace forcebound::server {

RequestJudge::RequestJudge(const ServerKeys& keys) {
  if (keys.shared) shared_.emplace(*keys.shared);
  replace(keys);
}

void RequestJudge::replace(const ServerKeys& keys) {
  has_list_ = keys.own && keys.clients;
  if (!has_list_) return;
  std::vector<Listed> listed;
  listed.reserve(keys.clients->all().size());
  for (const security::AllowedClient& client : keys.clients->all()) {
    const auto same = std::ranges::find(listed_, client.key, &Listed::key);
    listed.push_back({client.key, same == listed_.end() ? security::ProofKey(*keys.own, client.key) : same->proves});
  }
  listed_ = std::move(listed);
}

std::optional<std::uint64_t> RequestJudge::judge(const security::HandshakeRequest& request,
                                                 const net::Address& from) const noexcept {
  const security::RequestDigest digest = security::digest_of(request);
  if (shared_ && !shared_->made(request.proofs.shared, digest)) return std::nullopt;
  if (!has_list_) return shared_ ? std::optional(source_of(from)) : std::nullopt;
  const auto of = std::ranges::find_if(
      listed_, [&](const Listed& listed) { return listed.proves.made(request.proofs.own, digest); });
  return of == listed_.end() ? std::nullopt : std::optional(number_of(of->key));
}

bool RequestJudge::knows_shared(const security::HandshakeRequest& request) const noexcept {
  return !shared_ || shared_->made(request.proofs.shared, security::digest_of(request));
}

std::size_t RequestJudge::hashes() const noexcept {
  constexpr std::size_t kOfDigest = 16;
  return kOfDigest + listed_.size();
}

std::uint64_t RequestJudge::number_of(const security::PublicKey& key) noexcept {
  std::uint64_t number = 0;
  std::memcpy(&number, key.bytes.data(), sizeof number);
  return number;
}

}  // namespace forcebound::server
