#!/usr/bin/env bash
# Signs the files of a release, and verifies them: the sums of all files of a folder, and a signature of the sums by a key of
# OpenSSH or of GnuPG.
set -euo pipefail

usage() {
  cat <<'USAGE'
Usage: tools/scripts/sign_release.sh --ssh KEY FOLDER         writes FOLDER/SHA256SUMS and SHA256SUMS.sig
       tools/scripts/sign_release.sh --gpg KEY FOLDER         writes FOLDER/SHA256SUMS and SHA256SUMS.asc
       tools/scripts/sign_release.sh --verify SIGNERS FOLDER  that the signature is of one of SIGNERS and all files are signed

KEY is a file with a private key (or, with an agent, its public one) for --ssh, the name of a key for --gpg. SIGNERS has the
lines 'NAME PUBLIC-KEY' of the allowed signers of ssh-keygen for a .sig, and is a keyring made by 'gpg --export' for an .asc.
FOLDER holds the files of the release and nothing else.
Exit codes: 0 done; 2 wrong usage; 65 a signature or a file is not what it should be; 69 no such program; 74 cannot read or
write.
USAGE
}
fail() {
  echo "sign_release: $2" >&2
  exit "$1"
}
need() { command -v "$1" >/dev/null || fail 69 "there is no $1 here; install $2"; }

readonly purpose=gdtslam-release
if [[ ${1:-} == -h || ${1:-} == --help ]]; then usage && exit 0; fi
if (($# != 3)); then usage >&2 && exit 2; fi
mode=$1 key=$2 folder=$3
case "$mode" in --ssh | --gpg | --verify) ;; *) usage >&2 && exit 2 ;; esac
if [[ ! -d $folder ]]; then fail 74 "$folder is no folder"; fi
if [[ $mode != --gpg ]]; then
  if [[ ! -r $key ]]; then fail 74 "$key cannot be read"; fi
  key=$(readlink -f "$key")
fi
need sha256sum coreutils
cd "$folder"

# names_here FILE...: the names of the files but these, in an order that no locale changes. A name with a line end would be a line of its own.
names_here() {
  local name but=()
  for name in "$@"; do but+=(! -name "$name"); done
  find . -mindepth 1 -maxdepth 1 "${but[@]}" -printf '%f\0' | LC_ALL=C sort -z | while IFS= read -r -d '' name; do
    if [[ ! -f $name || -L $name || $name == *[!A-Za-z0-9._+~-]* || $name == -* ]]; then
      fail 65 "$(printf %q "$name") is no file of a release: plain files, of letters, digits and ._+~-"
    fi
    printf '%s\n' "$name"
  done
}

sign() {
  local names
  names=$(names_here SHA256SUMS SHA256SUMS.sig SHA256SUMS.asc) || exit $?
  if [[ -z $names ]]; then fail 65 "$folder holds no file"; fi
  rm -f SHA256SUMS SHA256SUMS.sig SHA256SUMS.asc
  # shellcheck disable=SC2086  # names of letters, digits and ._+~- without blanks
  sha256sum --binary $names >SHA256SUMS
  if [[ $mode == --ssh ]]; then
    need ssh-keygen openssh-client
    ssh-keygen -Y sign -q -f "$key" -n "$purpose" SHA256SUMS || fail 65 "$key did not sign"
  else
    need gpg gnupg
    gpg --batch --quiet --local-user "$key" --armor --detach-sign --output SHA256SUMS.asc SHA256SUMS || fail 65 "$key did not sign"
  fi
}

verify_ssh() {
  local signer
  need ssh-keygen openssh-client
  signer=$(ssh-keygen -Y find-principals -s SHA256SUMS.sig -f "$key" 2>/dev/null | head -n 1) || signer=
  if [[ -z $signer ]]; then fail 65 "SHA256SUMS.sig is by none of $key"; fi
  ssh-keygen -Y verify -q -f "$key" -I "$signer" -n "$purpose" -s SHA256SUMS.sig <SHA256SUMS >/dev/null 2>&1 ||
    fail 65 "SHA256SUMS.sig is no signature of SHA256SUMS by $signer"
  echo "signed by $signer"
}

verify_gpg() {
  local said
  need gpgv gpgv
  said=$(gpgv --status-fd 1 --keyring "$key" SHA256SUMS.asc SHA256SUMS 2>/dev/null) ||
    fail 65 "SHA256SUMS.asc is no signature of SHA256SUMS by a key of $key"
  if ! grep -q '^\[GNUPG:\] GOODSIG ' <<<"$said"; then fail 65 "SHA256SUMS.asc is by a key of $key that was revoked or has expired"; fi
  sed -n 's/^\[GNUPG:\] VALIDSIG \([0-9A-F]*\).*/signed by \1/p' <<<"$said"
}

# Who signed counts first: sums that nobody signed say nothing. Then each file, and that no other one lies beside them.
verify() {
  local names signature
  if [[ ! -f SHA256SUMS ]]; then fail 65 "$folder has no SHA256SUMS"; fi
  if [[ -f SHA256SUMS.sig ]]; then
    signature=SHA256SUMS.sig
    verify_ssh
  elif [[ -f SHA256SUMS.asc ]]; then
    signature=SHA256SUMS.asc
    verify_gpg
  else
    fail 65 "$folder has no SHA256SUMS.sig and no SHA256SUMS.asc"
  fi
  names=$(names_here SHA256SUMS "$signature") || exit $?
  if [[ $(sed 's/^[0-9a-f]\{64\} \*//' SHA256SUMS) != "$names" ]]; then
    fail 65 "the files of $folder are not those of SHA256SUMS"
  fi
  sha256sum --check --strict --quiet SHA256SUMS >/dev/null 2>&1 || fail 65 "a file of $folder is not the one that was signed"
  echo "$(wc -l <SHA256SUMS) files are what was signed"
}

if [[ $mode == --verify ]]; then verify; else sign; fi
