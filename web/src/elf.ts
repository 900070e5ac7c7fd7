// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** ELF files (System V ABI, chapter 4), as far as links need them. */

const SECTION_HEADER_BYTES = 40;
const SECTION_TYPE_NULL = 0;

/**
 * The same program with the contents of its debug sections zeroed, so that it packs well. A file
 * that is no 32-bit little-endian ELF file comes back as it is: the core says what is wrong.
 */
export function withoutDebugInformation(elf: Uint8Array): Uint8Array {
  const copy = elf.slice();
  const view = new DataView(copy.buffer);
  if (copy.length < 52 || view.getUint32(0) !== 0x7f454c46 || copy[4] !== 1) return copy;
  const table = view.getUint32(32, true);
  const [size, count, names] = [46, 48, 50].map((at) => view.getUint16(at, true)) as [
    number,
    number,
    number,
  ];
  if (size !== SECTION_HEADER_BYTES || table + size * count > copy.length || names >= count) {
    return copy;
  }
  const field = (section: number, at: number) => view.getUint32(table + section * size + at, true);
  const strings = field(names, 16);
  for (let section = 0; section < count; section += 1) {
    const start = strings + field(section, 0);
    const name = String.fromCharCode(...copy.subarray(start, start + 7));
    const [offset, length] = [field(section, 16), field(section, 20)];
    if (name === ".debug_" && offset + length <= copy.length) {
      copy.fill(0, offset, offset + length);
      view.setUint32(table + section * size + 4, SECTION_TYPE_NULL, true);
      view.setUint32(table + section * size + 20, 0, true);
    }
  }
  return copy;
}
