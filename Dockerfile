# Wayword's static binary and nothing else. `release/static` makes the binary first; no step here needs a network:
#
#     release/static && docker build --tag wayword .
#     docker run --rm --user "$(id -u):$(id -g)" --volume "$PWD:/work" wayword demo --seed 1
FROM scratch
# An empty folder that belongs to the user below, because a WORKDIR that is not there is made for root.
COPY --chown=65532:65532 target/static/work/ /work/
COPY target/static/wayword /wayword
# The ledger and weights of models go below it: into the folder that the user mounts.
ENV HOME=/work
WORKDIR /work
USER 65532:65532
ENTRYPOINT ["/wayword"]
