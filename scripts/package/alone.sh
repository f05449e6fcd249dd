# For scripts that must not run twice at the same time in one folder.

# alone FILE: takes the lock FILE, which is held until the script and all its children end; waits if another process holds it.
alone() {
  exec {lock}>"$1"
  if ! flock --nonblock "$lock"; then
    echo "scripts/${0##*/}: waiting for another one, which works in ${1%/*}" >&2
    flock "$lock"
  fi
}
