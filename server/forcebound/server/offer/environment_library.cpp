#include "forcebound/server/offer/environment_library.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "forcebound/text/names.hpp"

namespace forcebound::server {
namespace {

template <class Made>
void expect_complete(const Made& made) {
  if (!made.name.empty() && made.make) return;
  throw std::invalid_argument("environment '" + made.name + "' must have a name and a function that makes it");
}

}  // namespace

struct EnvironmentLibrary::Entry {
  std::string name;
  std::function<EnvironmentKind()> make{};        // empty: it was added as it is
  std::shared_ptr<const EnvironmentKind> kind{};  // null: not yet made
  bool coming = false;
  std::string why_not{};
};

struct EnvironmentLibrary::Shelf {
  Entry* find(std::string_view name) {
    const auto found = std::ranges::find(entries, name, &Entry::name);
    return found == entries.end() ? nullptr : &*found;
  }

  std::function<void(Later)> elsewhere{};
  std::vector<Entry> entries{};
};

EnvironmentLibrary::EnvironmentLibrary() : shelf_(std::make_shared<Shelf>()) {}

EnvironmentLibrary EnvironmentLibrary::copy() const {
  EnvironmentLibrary other;
  for (const Entry& entry : shelf_->entries) {
    other.shelf_->entries.push_back(
        {.name = entry.name, .make = entry.make, .kind = entry.make ? nullptr : entry.kind});
  }
  return other;
}

EnvironmentLibrary::Entry& EnvironmentLibrary::entry_for(std::string name) {
  Entry* const known = shelf_->find(name);
  Entry& entry = known == nullptr ? shelf_->entries.emplace_back() : *known;
  entry = {.name = std::move(name)};
  return entry;
}

void EnvironmentLibrary::add(EnvironmentKind kind) {
  expect_complete(kind);
  auto shared = std::make_shared<const EnvironmentKind>(std::move(kind));
  entry_for(shared->name).kind = shared;
}

void EnvironmentLibrary::add_later(Later later) {
  expect_complete(later);
  entry_for(std::move(later.name)).make = std::move(later.make);
}

void EnvironmentLibrary::make_elsewhere(std::function<void(Later)> elsewhere) {
  shelf_->elsewhere = std::move(elsewhere);
  for (Entry& entry : shelf_->entries) entry.coming = false;
}

void EnvironmentLibrary::store(std::string_view name, EnvironmentKind made) {
  Entry* const entry = shelf_->find(name);
  if (entry == nullptr || !entry->coming) return;
  entry->kind = std::make_shared<const EnvironmentKind>(std::move(made));
  entry->coming = false;
}

void EnvironmentLibrary::give_up(std::string_view name, std::string why) {
  Entry* const entry = shelf_->find(name);
  if (entry == nullptr) return;
  entry->coming = false;
  entry->why_not = std::move(why);
}

std::shared_ptr<const EnvironmentKind> EnvironmentLibrary::find(std::string_view name) const {
  Entry* const entry = shelf_->find(name);
  if (entry == nullptr) return nullptr;
  if (!entry->kind) entry->kind = std::make_shared<const EnvironmentKind>(entry->make());
  return entry->kind;
}

EnvironmentLibrary::Requested EnvironmentLibrary::request(std::string_view name) const {
  Entry* const entry = shelf_->find(name);
  if (entry == nullptr || entry->kind || !shelf_->elsewhere) return {.found = find(name)};
  if (!entry->why_not.empty()) return {.why_not = std::exchange(entry->why_not, {})};
  if (!std::exchange(entry->coming, true)) shelf_->elsewhere({entry->name, entry->make});
  return {.coming = true};
}

std::vector<std::string> EnvironmentLibrary::names() const {
  std::vector<std::string> names;
  names.reserve(shelf_->entries.size());
  for (const Entry& known : shelf_->entries) names.push_back(known.name);
  return names;
}

std::string EnvironmentLibrary::unknown_text(std::string_view name) const {
  return "no scene '" + std::string(name) + "'" + text::suggestion(name, names());
}

}  // namespace forcebound::server
