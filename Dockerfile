# docker build -t leastaction . && docker run --rm -p 127.0.0.1:8080:8080 leastaction

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
USER leastaction
EXPOSE 8080
STOPSIGNAL SIGTERM
HEALTHCHECK --interval=10s --timeout=3s --start-period=5s \
  CMD ["bash", "-c", "exec 3<>/dev/tcp/127.0.0.1/${LEASTACTION_PORT:-8080} && printf 'GET /healthz HTTP/1.1\\r\\nHost: localhost\\r\\nConnection: close\\r\\n\\r\\n' >&3 && read -r line <&3 && [[ $line == 'HTTP/1.1 200 '* ]]"]
ENTRYPOINT ["leastaction"]
CMD ["serve", "--host", "0.0.0.0"]
