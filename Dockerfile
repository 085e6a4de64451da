# The demo without a display, from a bare Debian on; it leaves fall.bag in the folder mounted as /bags:
#   docker build -t ragdoll .
#   docker run --rm -it -v "$PWD:/bags" ragdoll
# The tests: docker run --rm ragdoll ./test
FROM debian:12
COPY . /ragdoll
WORKDIR /ragdoll
RUN ./run --setup
CMD ["./run", "rviz:=false", "bag:=/bags/fall.bag"]
