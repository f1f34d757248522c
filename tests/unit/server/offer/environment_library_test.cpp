#include "forcebound/server/offer/environment_library.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace forcebound::server {
namespace {

using Later = EnvironmentLibrary::Later;

EnvironmentKind kind(const std::string& name) {
  return {.name = name, .make = [](const ClientFacts&) { return MadeEnvironment{}; }};
}

/// Environments that are made when they are requested, and how often they were.
struct Slow {
  EnvironmentLibrary library{};
  std::shared_ptr<int> made = std::make_shared<int>(0);

  Slow() {
    for (const std::string name : {"pad", "wall"}) {
      library.add_later({.name = name, .make = [name, made = made] {
                           ++*made;
                           return kind(name);
                         }});
    }
  }
};

TEST(EnvironmentLibrary, RefusesAKindWithoutANameOrAFunction) {
  EnvironmentLibrary environments;
  EXPECT_THROW(environments.add({.name = "nothing"}), std::invalid_argument);
  EXPECT_THROW(environments.add({.make = kind("").make}), std::invalid_argument);
  EXPECT_THROW(environments.add_later({.name = "nothing"}), std::invalid_argument);
  EXPECT_TRUE(environments.names().empty());
}

TEST(EnvironmentLibrary, MakesOneAtItsFirstRequestAndKeepsIt) {
  const Slow slow;
  const auto wall = slow.library.find("wall");
  ASSERT_NE(wall, nullptr);
  EXPECT_EQ(wall->name, "wall");
  EXPECT_EQ(slow.library.request("wall").found, wall) << "who shares a scene must meet the same one";
  EXPECT_EQ(*slow.made, 1);
  EXPECT_EQ(slow.library.find("wal"), nullptr);
  EXPECT_EQ(slow.library.unknown_text("wal"), "no scene 'wal', did you mean 'wall'? (known: pad, wall)");
}

TEST(EnvironmentLibrary, ACopyMakesItsOwnAndSharesWhatWasAddedAsItIs) {
  Slow slow;
  slow.library.add(kind("own"));
  const auto wall = slow.library.find("wall");
  const EnvironmentLibrary copy = slow.library.copy();
  EXPECT_EQ(copy.names(), slow.library.names());
  EXPECT_NE(copy.find("wall"), wall);
  EXPECT_EQ(copy.find("own"), slow.library.find("own"));
  EXPECT_EQ(*slow.made, 2);
}

TEST(EnvironmentLibrary, RequestReturnsAtOnceWhileAnEnvironmentIsMadeElsewhere) {
  Slow slow;
  std::vector<Later> wanted;
  slow.library.make_elsewhere([&](Later later) { wanted.push_back(std::move(later)); });
  for (int i = 0; i < 3; ++i) {
    const auto requested = slow.library.request("pad");
    EXPECT_TRUE(requested.coming);
    EXPECT_EQ(requested.found, nullptr);
  }
  ASSERT_EQ(wanted.size(), 1U);
  EXPECT_EQ(wanted.front().name, "pad");
  slow.library.store("pad", wanted.front().make());
  EXPECT_NE(slow.library.request("pad").found, nullptr);
  EXPECT_FALSE(slow.library.request("pad").coming);
  EXPECT_FALSE(slow.library.request("no such scene").coming);
  EXPECT_EQ(wanted.size(), 1U);
}

TEST(EnvironmentLibrary, AFailureIsReportedOnceAndThenRetried) {
  Slow slow;
  int asked = 0;
  slow.library.make_elsewhere([&](const Later&) { ++asked; });
  EXPECT_TRUE(slow.library.request("pad").coming);
  slow.library.give_up("pad", "no memory");
  const auto told = slow.library.request("pad");
  EXPECT_EQ(told.why_not, "no memory");
  EXPECT_FALSE(told.coming);
  EXPECT_EQ(asked, 1);
  EXPECT_TRUE(slow.library.request("pad").coming);
  EXPECT_EQ(asked, 2);
}

TEST(EnvironmentLibrary, WhatIsAddedMeanwhileIsNotReplacedByWhatWasBeingMade) {
  Slow slow;
  slow.library.make_elsewhere([](const Later&) {});
  EXPECT_TRUE(slow.library.request("pad").coming);
  slow.library.add(kind("pad"));
  const auto added = slow.library.find("pad");
  slow.library.store("pad", kind("pad"));
  EXPECT_EQ(slow.library.find("pad"), added);
}

TEST(EnvironmentKind, AcceptsAnyDegreesOfFreedomIfItListsNone) {
  const EnvironmentKind any;
  EXPECT_FALSE(any.accepts(0));
  EXPECT_TRUE(any.accepts(1));
  EXPECT_TRUE(any.accepts(6));
  EXPECT_FALSE(any.accepts(7));
  EXPECT_EQ(any.accepted_degrees_of_freedom(), "1 to 6");
}

}  // namespace
}  // namespace forcebound::server
