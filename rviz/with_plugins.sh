#!/bin/sh
# Runs rviz, whose command line is given: with_plugins.sh rviz -d CONFIG ... Where ragdoll_rviz is not
# built, rviz gets a copy of CONFIG that does without its panel and its tool, and shows bodies as the
# node's markers in place of its display. Where there is no CONFIG rviz would show nothing, and say
# nothing.
last=
for word in "$@"; do
  if [ "$last" = -d ] && [ ! -f "$word" ]; then
    echo "rviz: no view $word; there are" "$(cd "$(dirname "$0")" && echo *.rviz | sed 's/\.rviz//g')" >&2
    exit 2
  fi
  last=$word
done
last=
if ! rospack find ragdoll_rviz >/dev/null 2>&1; then
  for word in "$@"; do
    shift
    if [ "$last" = -d ]; then
      copy=$(mktemp --suffix=.rviz)
      # Leaves out the items of lists that are of its classes.
      awk '{ match($0, /^ */) }
        out && RLENGTH > indent { next }
        { out = /^ *- Class: ragdoll_rviz\//; indent = RLENGTH }
        !out { sub(/\/scenery$/, "/markers"); print }' "$word" >"$copy"
      set -- "$@" "$copy"
    else
      set -- "$@" "$word"
    fi
    last=$word
  done
fi
exec "$@"
