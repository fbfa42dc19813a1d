#!/usr/bin/env bash
# Prepares what stands beside Saltus: a Python with pinned Pinocchio and CasADi, and the peer benches.
#   setup.sh venv    the Python environment in .venv (about 300 MB)
#   setup.sh ratios  the environment, with what the tables of QPs and planners need (another 150 MB)
#   setup.sh mjcf    the environment, MuJoCo, and the packages whose MJCF files are compared (another 150 MB)
#   setup.sh bench   the environment, and the C++ benches (6 minutes of clang; needs Debian's clang and libeigen3-dev)
# Results go to target/peers (SALTUS_PEERS_DIR to place them elsewhere); what is up to date is not built again.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
out=${SALTUS_PEERS_DIR:-$root/target/peers}
venv=${SALTUS_VENV:-$root/.venv}
python=$venv/bin/python
eigen=${EIGEN:-/usr/include/eigen3}

make_venv() {
  [ -x "$python" ] || python3 -m venv "$venv"
  install requirements.txt .saltus-requirements
}

# install FILE STAMP: what FILE lists, unless STAMP says that it is there
install() {
  if ! cmp -s "$here/$1" "$venv/$2"; then
    "$python" -m pip install --quiet --requirement "$here/$1"
    cp "$here/$1" "$venv/$2"
  fi
}

# MuJoCo; gymnasium and dm_control only for the robots in them, without what they need to run
install_mjcf() {
  install requirements-mjcf.txt .saltus-requirements-mjcf
  "$python" -m pip install --quiet --no-deps gymnasium==1.4.0 dm_control==1.0.50
}

# newer TARGET SOURCE...: TARGET exists and is newer than every SOURCE
newer() {
  local target=$1 source
  shift
  [ -e "$target" ] || return 1
  for source in "$@"; do [ "$target" -nt "$source" ] || return 1; done
}

make_bench() {
  command -v clang++ >/dev/null || { echo "clang++ is missing: apt-get install clang libeigen3-dev" >&2; exit 1; }
  [ -d "$eigen/Eigen" ] || { echo "no Eigen headers in $eigen: apt-get install libeigen3-dev (or set EIGEN)" >&2; exit 1; }
  mkdir -p "$out"
  local prefix casadi
  prefix=$("$python" -c "import cmeel, pathlib; print(pathlib.Path(cmeel.__file__).parent.parent / 'cmeel.prefix')")
  casadi=$("$python" -c "import casadi, pathlib; print(pathlib.Path(casadi.__file__).parent)")
  local flags=(-std=c++17 -DNDEBUG -w -DBOOST_MPL_LIMIT_LIST_SIZE=30 -DBOOST_MPL_LIMIT_VECTOR_SIZE=30
    -DBOOST_FUSION_INVOKE_MAX_ARITY=12 -DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS
    -isystem "$prefix/include" -isystem "$eigen")
  if ! newer "$out/icub23.states" "$here/dump_models.py" "$here/robots.py" "$root"/models/*.urdf; then
    "$python" "$here/dump_models.py" "$out"
  fi
  if ! newer "$out/pinocchio" "$here"/pinocchio/* "$here/common.hpp"; then
    echo "compiling Pinocchio's bench (minutes)"
    clang++ "${flags[@]}" -O3 -march=native "$here/pinocchio/bench.cpp" -o "$out/pinocchio"
  fi
  if ! newer "$out/gen" "$here/casadi/gen.cpp" "$here/pinocchio/model.hpp"; then
    echo "compiling CasADi's generator (minutes)"
    clang++ "${flags[@]}" -O0 -isystem "$casadi/include" "$here/casadi/gen.cpp" -L"$casadi" -lcasadi -Wl,-rpath,"$casadi" -o "$out/gen"
  fi
  local robot
  for robot in a1 icub23; do
    if ! newer "$out/casadi-$robot" "$out/gen" "$out/$robot.model" "$here/casadi/bench_gen.cpp" "$here/common.hpp"; then
      (cd "$out" && ./gen "$robot.model" "$robot")
      clang -O3 -march=native -ffp-contract=fast -w -c "$out/${robot}_gen.c" -o "$out/${robot}_gen.o"
      clang++ -std=c++17 -O2 -DROBOT="$robot" "$here/casadi/bench_gen.cpp" "$out/${robot}_gen.o" -o "$out/casadi-$robot"
    fi
  done
}

case "${1:-bench}" in
  venv) make_venv ;;
  ratios) make_venv; install requirements-bench.txt .saltus-requirements-bench ;;
  mjcf) make_venv; install_mjcf ;;
  bench) make_venv; make_bench ;;
  *) echo "usage: setup.sh [venv|ratios|mjcf|bench]" >&2; exit 2 ;;
esac
