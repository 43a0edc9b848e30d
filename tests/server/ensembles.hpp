// Ensembles as tests ask for them.
#pragma once

#include <string>

#include "server/decode/json_parse.hpp"

namespace least::server::test {

inline const std::string orbits =
    R"js({"problem":"kepler","initial":{"x":1,"y":0,"px":0,"py":1},"scheme":{"id":"leapfrog","step":0.05},
        "until":{"t":3},"members":{"count":9000,"seed":7,"vary":{"/initial/x":{"uniform":[0.8,1.2]},
        "/initial/px":{"normal":[0,0.05]}}},"columns":["x","y","energy",{"name":"r","expression":"sqrt(x^2+y^2)"}],
        "keep":["statistics","final","section"],"section":{"period":1.5},
        "histograms":{"x":{"range":[-2,2],"bins":8},"r":{"range":[0,2],"bins":4}}})js";

inline Json without_cost(const std::string& text) {
  Json answer = Json::parse(text);
  answer.erase("cost");
  return answer;
}

}  // namespace least::server::test
