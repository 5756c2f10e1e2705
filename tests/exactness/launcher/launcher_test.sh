#!/usr/bin/env bash
# Claims about the launcher, whose path is the argument. It is copied into a tree of its own, in which a script stands for the
# program and another one for ninja.
set -uo pipefail

tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
build=$tree/build/release
mkdir -p "$build/bin" "$tree/tools"
cp "$1" "$tree/talus"
echo bash >"$tree/packages.txt"
echo '{}' >"$tree/CMakePresets.json"
touch "$build/build.ninja" "$build/CMakeCache.txt" "$build/configured"
printf '#!/bin/sh\necho "program: $*; launcher: $TALUS_LAUNCHER_COMMANDS"\n' >"$build/bin/talus"
printf '#!/bin/sh\necho "built $*" >>"%s"\n' "$tree/built" >"$tree/tools/ninja"
chmod +x "$build/bin/talus" "$tree/tools/ninja"
export PATH=$tree/tools:$PATH

failures=0
# claim SENTENCE EXPECTED OUTPUT: the output has the expected text.
claim() {
  [[ $3 == *"$2"* ]] && return
  printf 'NOT TRUE: %s\n  expected: %s\n  output: %s\n' "$1" "$2" "$3"
  failures=$((failures + 1))
}
launch() { timeout 10 "$tree/talus" "$@" 2>&1; }

output=$(launch test --help)
claim "test --help prints help" "builds the program and its tests and runs them" "$output"
output=$(launch test -R something --help)
claim "--help of the tests may stand last" "builds the program and its tests and runs them" "$output"
claim "help of the tests builds nothing" "nothing" "$([[ -e $tree/built ]] && echo something || echo nothing)"
claim "the program knows the commands of the launcher" "launcher: test" "$(launch tset)"
claim "a command builds" "built" "$(cat "$tree/built")"
rm "$tree/built"
claim "verify is the program's" "program: verify at_rest" "$(launch verify at_rest)"
claim "its own program is built for it" "talus-verify" "$(cat "$tree/built")"

exec 8>"$build/lock"
flock 8
for words in "check slope.toml" "describe gravity" "--help" "run --help" "check --help" "rnu"; do
  # shellcheck disable=SC2086
  claim "$words does not wait for a build" "program: " "$(launch $words 8>&-)"
done
claim "a run waits for a build" "waiting for another build" "$(timeout 2 "$tree/talus" run slope.toml 2>&1 8>&-)"
mv "$build/bin/talus" "$build/bin/elsewhere"
claim "without a program check waits" "waiting for another build" "$(timeout 2 "$tree/talus" check slope.toml 2>&1 8>&-)"
mv "$build/bin/elsewhere" "$build/bin/talus"
flock -u 8

# ranks have the time to write what they have computed, also more than the second that mpirun gives them
cat >"$build/bin/talus" <<'TEXT'
#!/bin/sh
trap 'sleep 3; echo "ended in order"; sleep 0.5; exit 3' USR1  # the first rank that ends has mpirun kill the other
touch "$BEGUN.$OMPI_COMM_WORLD_RANK"
while :; do sleep 0.1; done
TEXT
for signal in TERM INT; do
  export BEGUN=$tree/begun_$signal
  # with job control, since what bash starts in the background without it ignores SIGINT
  output=$(set -m; timeout 60 "$tree/talus" run slope.toml -n 2 2>&1 & launcher=$!
           for _ in {1..200}; do [[ -e $BEGUN.0 && -e $BEGUN.1 ]] && break; sleep 0.1; done
           kill -$signal $launcher; wait $launcher; echo "status $?")
  claim "ranks end in order by SIG$signal" "2" "$(grep -c "ended in order" <<<"$output")"
  claim "the launcher has the status of the ranks" "status 3" "$output"
done

# whether ranks are bound to cores, on a machine that has two: what mpirun is told, and the program where it runs alone
unset OMPI_MCA_hwloc_base_binding_policy PRTE_MCA_hwloc_default_binding_policy
printf '#!/bin/sh\necho 2\n' >"$tree/tools/nproc"
printf '#!/bin/sh\necho "binding: $OMPI_MCA_hwloc_base_binding_policy, $PRTE_MCA_hwloc_default_binding_policy"\n' >"$build/bin/talus"
cp "$build/bin/talus" "$tree/tools/mpirun"
chmod +x "$tree/tools/nproc" "$build/bin/talus" "$tree/tools/mpirun"
claim "as many ranks as cores are bound" "binding: core:if-supported, core:if-supported" "$(launch run slope.toml -n 2)"
claim "one rank is not" "binding: none, none" "$(launch run slope.toml)"
claim "more ranks than cores are not" "binding: none, none" "$(launch run slope.toml -n 3)"
claim "a choice of the user's stands" "binding: socket, socket" "$(OMPI_MCA_hwloc_base_binding_policy=socket launch run slope.toml -n 2)"

# a search for networks would take most of the time of the tests: what the system leaves out of it is left out there too
printf '#!/bin/sh\necho "networks: $OMPI_MCA_btl,"\n' >"$tree/tools/ctest"
chmod +x "$tree/tools/ctest"
for network in tcp $(sed -n 's/^btl *= *^//p' /etc/openmpi/openmpi-mca-params.conf 2>/dev/null | tr , ' '); do
  claim "the tests do without $network" "$network," "$(launch test | grep '^networks: ^' | tr '^' ',')"
done
exit $((failures > 0))
