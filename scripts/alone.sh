# For scripts that must not work twice at once in one place.

# alone FILE: holds the lock FILE until the script and all that it started have ended; waits, with a word, for others.
alone() {
  exec {lock}>"$1"
  if ! flock --nonblock "$lock"; then
    echo "scripts/${0##*/}: waiting for another one, which works in ${1%/*}" >&2
    flock "$lock"
  fi
}
