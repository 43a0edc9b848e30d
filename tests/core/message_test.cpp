// Messages of a run, in which times stay numbers until the text is read.
#include "core/run/message.hpp"

#include <gtest/gtest.h>

#include <string>

#include "core/run/messages.hpp"

namespace {

using least::Message;

TEST(Message, PutsItsTimesIntoWords) {
  EXPECT_EQ(Message().text(), "");
  EXPECT_TRUE(Message().empty());
  EXPECT_EQ(Message::time(1.5).text(), "t = 1.5");
  EXPECT_EQ(Message::time(0.1).text(), "t = 0.1");
  EXPECT_EQ(Message::time(2.0 / 3, 4).text(), "t = 0.6667");
  EXPECT_EQ((Message::time(1) + " and " + Message::time(-2) + std::string(" are two")).text(),
            "t = 1 and t = -2 are two");
  EXPECT_EQ(least::messages::departs(0.25, 1, 2).text(),
            "at t = 1 it is off by 0.25, by a control run of Dormand–Prince 5(4) that went as far as t = 2");
}

// turn_times() changes the sign of times only; text that looks like a time stays.
TEST(Message, TurnsTimesAndNoWords) {
  Message message = "what Start = 1 and t = 5 set at " + Message::time(3) + ", not " + Message::time(0);
  message.turn_times();
  EXPECT_EQ(message.text(), "what Start = 1 and t = 5 set at t = -3, not t = 0");
  message.turn_times();
  EXPECT_EQ(message.text(), "what Start = 1 and t = 5 set at t = 3, not t = 0");
}

}  // namespace
