// POST /v1/problems: the card of a scene, in particular of one given as text.
#pragma once

#include "server/endpoint.hpp"

namespace least::server {

/// describe_scene answers with the card of the scene in the request.
Prepared describe_scene(const Context& context, const HttpRequest& request);

}  // namespace least::server
