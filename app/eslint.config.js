import hooks from "eslint-plugin-react-hooks";
import { defineConfig, globalIgnores } from "eslint/config";
import tseslint from "typescript-eslint";

export default defineConfig(globalIgnores(["src/api/schema.d.ts", "node_modules"]), tseslint.configs.strict, {
  plugins: { "react-hooks": hooks },
  rules: { "react-hooks/rules-of-hooks": "error" },
});
