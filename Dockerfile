# docker build -t leastaction . && docker run --rm -p 127.0.0.1:8080:8080 leastaction
#
# It writes no file, needs no right and few processes, and every option comes from the environment, too:
# docker run --rm -p 127.0.0.1:8080:8080 --read-only --cap-drop all --pids-limit 64 --memory 256m \
#   -e LEASTACTION_MAX_MEMORY=134217728 -e LEASTACTION_LOG_FORMAT=json leastaction

FROM debian:trixie-slim AS build
WORKDIR /src
# The packages first: a changed source does not install them again.
COPY dev ./
COPY web/package.json web/package-lock.json web/.npmrc web/
RUN ./dev setup build
COPY . .
RUN ./dev build && strip build/release/leastaction

FROM debian:trixie-slim
# Quad precision needs libquadmath only where long double is short of it.
RUN case $(dpkg --print-architecture) in amd64 | i386 | ppc64el) quad=libquadmath0 ;; esac \
 && apt-get update -q \
 && DEBIAN_FRONTEND=noninteractive apt-get install -qy --no-install-recommends \
      libcpp-httplib0.18 libfmt10 libsleef3 libspdlog1.15 libssl3t64 libstdc++6 $quad \
 && rm -rf /var/lib/apt/lists/* \
 && useradd --system --user-group --no-create-home --home-dir /nonexistent --shell /usr/sbin/nologin leastaction
COPY --from=build /src/build/release/leastaction /usr/local/bin/
LABEL org.opencontainers.image.title="leastaction" org.opencontainers.image.licenses="MIT" \
      org.opencontainers.image.description="Structure-preserving integration of mechanical systems as a service"
USER leastaction
EXPOSE 8080
STOPSIGNAL SIGTERM
# Follows LEASTACTION_PORT; a port given on the command line has to be given here, too.
HEALTHCHECK --interval=10s --timeout=3s --start-period=5s CMD ["leastaction", "health"]
ENTRYPOINT ["leastaction"]
CMD ["serve", "--host", "0.0.0.0"]
