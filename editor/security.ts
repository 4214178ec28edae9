/** Nothing is loaded from or sent to any other place, and no text is run as a program. WebAssembly needs its own word for itself. */
export const contentSecurityPolicy = [
  "default-src 'none'",
  "script-src 'self' 'wasm-unsafe-eval'",
  "worker-src 'self'",
  "connect-src 'self' blob:",
  "style-src 'self'",
  "img-src 'self' blob: data:",
  "base-uri 'none'",
  "form-action 'none'",
].join("; ");

/** Where the built editor has it, for who serves it with headers. */
export const fileOfPolicy = "content-security-policy.txt";
