// An archive of texts, stored without compression.
const TABLE = Uint32Array.from({ length: 256 }, (_, at) => {
  let value = at;
  for (let bit = 0; bit < 8; bit++) value = value & 1 ? 0xedb88320 ^ (value >>> 1) : value >>> 1;
  return value >>> 0;
});

const checksum = (bytes) => {
  let value = 0xffffffff;
  for (const byte of bytes) value = TABLE[(value ^ byte) & 255] ^ (value >>> 8);
  return (value ^ 0xffffffff) >>> 0;
};

// Writes numbers of two ("h") or four ("w") bytes, little end first.
const pack = (form, ...numbers) => {
  const view = new DataView(new ArrayBuffer([...form].reduce((sum, kind) => sum + (kind === "h" ? 2 : 4), 0)));
  let at = 0;
  [...form].forEach((kind, index) => {
    if (kind === "h") { view.setUint16(at, numbers[index], true); at += 2; }
    else { view.setUint32(at, numbers[index], true); at += 4; }
  });
  return new Uint8Array(view.buffer);
};

export const zip = (files) => {
  const parts = [];
  const directory = [];
  let at = 0;
  const UTF8 = 0x800, DATE = 0x21;
  for (const { name, text } of files) {
    const [bytes, title] = [text, name].map((own) => new TextEncoder().encode(own));
    const shared = [20, UTF8, 0, 0, DATE, checksum(bytes), bytes.length, bytes.length, title.length, 0];
    const head = pack("whhhhhwwwhh", 0x04034b50, ...shared);
    directory.push(pack("whhhhhhwwwhhhhhww", 0x02014b50, 20, ...shared, 0, 0, 0, 0, at), title);
    parts.push(head, title, bytes);
    at += head.length + title.length + bytes.length;
  }
  const size = directory.reduce((sum, part) => sum + part.length, 0);
  const end = pack("whhhhwwh", 0x06054b50, 0, 0, files.length, files.length, size, at, 0);
  return new Blob([...parts, ...directory, end]);
};
