// Unpacks the Chromium of the tests, with the libraries and fonts that a bare machine lacks, into the folder named by
// TMPDIR, and prints where it is.
process.env.AWS_EXECUTION_ENV = "AWS_Lambda_nodejs22.x"; // the package adds its libraries only where it believes to be
const { default: chromium } = await import("@sparticuz/chromium");
console.log(await chromium.executablePath());
